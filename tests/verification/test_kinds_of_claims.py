"""Claims, proofs, regions and cuts of others with values that these do not have: refused in one line."""

from math import inf, nan
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign.beams import withstood
from proofs import Patches, everything, planar, solid
from regrasp.errors import InvalidInput
from regrasp.verification import kinds
from scenarios import planned
from values import VALUES

pytestmark = pytest.mark.contract


class Shy:
    """Says nothing about itself."""

    def __getattr__(self, name: str) -> object:
        raise RuntimeError(name)


NO_KIND = (
    "text", 1j, 10**400, {}, object(), Shy(), b"x", ([],), [None], ["1"], (None,), [[1, [2]]],
    np.array(["a"]), np.array([None]), np.array(nan), (n for n in ()), lambda *a: 1,
)  # fmt: skip
OTHERS = (
    None, nan, inf, -inf, -1, 1e300, 10**30, True, np.zeros(0), np.zeros((0, 2)), np.zeros((2, 3, 4)),
    np.ones((3, 3)), np.full((1, 3), nan),
)  # fmt: skip
WORDS = ("objective", "size", "norm")  # of which none is a word that has a meaning
CLAIMS = {
    "withstood": withstood,
    **{n: VALUES[n] for n in ("ContactRegions", "FaceRegions", "OutlineCut", "RegraspCut")},
    "proof on a face": lambda: solid(
        [np.eye(3)],
        [np.ones(3) / 3**0.5],
        [[0, 0, -1.0, 0, 0, 0]],
        Patches([(0, 1)], [[-1, -1, -1]]),
        [([0], (0, 0), 0, np.zeros(6))],
    ),
}


def parts(value) -> dict[str, object]:
    given = (
        vars(value)
        if isinstance(value, SimpleNamespace)
        else {n: getattr(value, n) for n in value.__match_args__}
    )
    return {name: part for name, part in given.items() if name != "alone"}  # which no claim rests on


def said(claim) -> str:
    """What is wrong, in lines of its own; "" of what is verified."""
    try:
        verdict = rg.verify(claim)
    except InvalidInput as error:
        return f"InvalidInput: {error}"
    return "" if verdict.ok else "\n".join(verdict.violations)


def refuses(make, given: dict[str, object], at: str) -> None:
    for name in given:
        for junk in NO_KIND:
            words = said(make(given | {name: junk}))
            assert "\n" not in words or name in WORDS
            kind = words.startswith(f"InvalidInput: {at}{name}")
            assert kind or (name in WORDS and junk == "text"), (name, junk)
        for junk in OTHERS:
            said(make(given | {name: junk}))
        without = said(make({n: v for n, v in given.items() if n != name}))
        assert without.startswith("InvalidInput: "), name


@pytest.mark.parametrize("kind", CLAIMS)
def test_values_of_no_kind_are_refused_in_a_line(kind) -> None:
    given = parts(CLAIMS[kind]())
    refuses(lambda values: SimpleNamespace(**values), given, "")
    if kind == "withstood":
        proof = parts(given["certificate"])
        refuses(
            lambda v: SimpleNamespace(**given | {"certificate": SimpleNamespace(**v)}), proof, "certificate."
        )
        refuses(lambda v: SimpleNamespace(**v), proof, "")


@pytest.mark.parametrize("kind", ["withstood", "ContactRegions", "FaceRegions"])
def test_shapes_answer_as_shapes_do(kind) -> None:
    given = parts(CLAIMS[kind]())
    names = ("surface", "centre_of_mass") if kind == "FaceRegions" else ("polygon", "cubics", "points")
    shape = {name: getattr(given["shape"], name) for name in names}

    def asked(shape) -> str:
        return said(SimpleNamespace(**given | {"shape": SimpleNamespace(**shape)}))

    assert asked(shape) == ""
    for name in names:
        if (kind, name) == ("withstood", "points"):
            continue  # of curved regions
        for junk in NO_KIND + OTHERS:
            for answer in [junk] if name == "centre_of_mass" else [junk, lambda *a, junk=junk: junk]:
                words = asked(shape | {name: answer})
                assert words or (name, junk) == ("cubics", None), (name, junk)
    proof = SimpleNamespace(**vars(withstood().certificate) | {"rings": np.array([0, 4, 8])})
    for junk in NO_KIND + OTHERS if kind == "withstood" else ():
        ringed = SimpleNamespace(**shape, hole_polygons=lambda junk=junk: junk)
        words = said(SimpleNamespace(**given | {"shape": ringed, "certificate": proof}))
        assert "hole_polygons" in words


def test_states_and_grasps_passed_over_are_some() -> None:
    good = vars(withstood())
    flat = good["states"]
    solid = VALUES["FaceRegions"]().grasp
    other = {"value": 1.0, "grasp": good["grasp"], "places": good["places"]}
    parted = [
        SimpleNamespace(**other | part) for part in ({"grasp": solid}, {"places": [[1.0]]}, {"value": "1"})
    ]
    for name, value in (
        ("states", (None,)), ("states", (*flat[:2], "state")), ("others", (None,)), ("others", (Shy(),)),
        *(("others", (part,)) for part in parted), ("grasp", solid), ("grasp", flat[0]), ("shape", Shy()),
    ):  # fmt: skip
        assert said(SimpleNamespace(**good | {name: value})).startswith(f"InvalidInput: {name}"), name
    assert said(SimpleNamespace(**good | {"states": list(flat)})) == ""
    mesh = VALUES["FaceRegions"]().shape
    assert said(SimpleNamespace(**good | {"shape": mesh})) == "the proof is about an outline"
    for anything in Shy(), None, 1, [], "plan":
        assert said(anything).startswith("InvalidInput: verify needs a plan")


def test_limits_that_are_no_numbers_are_kept_by_none() -> None:
    state = rg.GraspState(rg.Grasp([rg.Contact([0, -1], [0, 1], 0.0)]), rg.Wrench([0, -1]), [[0, 1]])
    good = vars(withstood()) | {"objective": "peak", "grasp": state.grasp, "states": (state,)}
    assert "above the limit nan" in said(SimpleNamespace(**good | {"max_force": nan}))


def test_a_cut_has_no_least_distance_below_zero() -> None:
    """Of which the square excluded pairs that may hold."""
    cut = parts(VALUES["RegraspCut"]())
    for name in "min_distance", "least_margin":
        for junk in (-5.0, -1e-300, nan, inf):
            words = said(SimpleNamespace(**cut | {name: junk}))
            assert words.startswith(f"InvalidInput: {name} of a plan must be a number of 0 or more")
    box = VALUES["FaceRegions"]().grasp
    assert "contacts in the plane" in said(SimpleNamespace(**cut | {"contacts": tuple(box)}))


def test_numbers_and_rows_at_their_limits() -> None:
    rows = np.ones((2, 2))
    for (is_so, _), good, bad in (
        (kinds._NUMBER, (2**1023 - 1, 0.5, 1), (2**1023, True, "1")),
        (kinds._DOUBLE, (2**63 - 1, 0.5, nan), (2**63, None)),
        (kinds._LEAST_0, (0, 0.0, 5e-324), (-5e-324, inf, nan)),
        (kinds._COUNT, (0, 1, 63, 2**31 - 1), (-1, 2**31, 1.0)),
        (kinds._ROW, ((), [1, 0.5], np.ones(2)), ([1, "a"], rows, np.ones(2, dtype=complex))),
        (kinds._ARRAY, (rows, np.array(1)), (rows.astype(np.longdouble), [1.0])),
        (kinds._POINT, (np.ones(2),), (np.ones(3), [1.0, 1.0])),
        (kinds._RINGS, ((), (rows,), [rows]), ((np.ones((2, 3)),), (1,))),
        (kinds._OUTLINE, (np.ones((3, 2)),), (rows, np.array([[nan, 0], [1, 0], [0, 1]]))),
        (kinds._CUBICS, (np.ones((1, 4, 2)), np.ones((3, 4, 2))), (np.ones((1, 5, 2)), np.ones((1, 4, 3)))),
    ):  # fmt: skip
        assert all(is_so(value) for value in good), good
        assert not any(is_so(value) for value in bad), bad


def test_kinds_of_grasps_and_cubics() -> None:
    planar, spatial = (rg.Grasp([rg.Contact(np.zeros(d), np.eye(d)[0], 0.5)]) for d in (2, 3))
    for kind, grasp in (kinds._PLANAR, planar), (kinds._SPATIAL, spatial):
        assert [kind[0](g) for g in (planar, spatial)] == [g is grasp for g in (planar, spatial)]
    assert kinds._CUBICS[0](np.zeros((1, 4, 2)))
    assert not kinds._CUBICS[0](np.full((1, 4, 2), None))
    assert not kinds._is_array(np.zeros(2, dtype=np.longdouble)) or np.dtype(np.longdouble).itemsize == 8


def refused(check, value) -> str:
    try:
        check(value)
    except InvalidInput as error:
        return str(error)
    return ""


def test_transitions_and_regrasps_have_values_of_their_kinds() -> None:
    whole = {"disturbance": None, "stiffness": None, "early_loss": None}
    record = {"reserve": 0.1, "balancing": 0.0, "choices": (), "rate_limits": (), "least_normals": ()}

    def transition(**more):
        scaling = SimpleNamespace(duration=1.0, control=(1.0, 0.0))
        kept = SimpleNamespace(**record | more)
        return SimpleNamespace(scaling=scaling, course=None, turn=None, record=kept)

    for withstands, good in (None, True), (SimpleNamespace(**whole), True), ("x", False):
        words = refused(kinds.check_transition, transition(withstands=withstands))
        assert words.startswith("" if good else "record.withstands")
        assert bool(words) != good
    for name in whole:
        less = SimpleNamespace(**{n: v for n, v in whole.items() if n != name})
        assert f"record.withstands.{name}" in refused(kinds.check_transition, transition(withstands=less))
    assert refused(kinds.check_transition, transition()) == ""
    plan = {"steps": (), "orientations": (0.0,), "margin": 0.1}
    for name, value, good in (
        ("steps", (), True), ("steps", None, False), ("steps", (object(),), False), ("margin", "1", False),
        ("orientations", "1", False), ("rotations", None, True), ("rotations", np.zeros((1, 3, 3)), True),
        ("rotations", "1", False), ("steps", (planned(),), True),
    ):  # fmt: skip
        words = refused(kinds.check_regrasp, SimpleNamespace(**plan | {name: value}))
        assert words.startswith(name if not good else "")
        assert bool(words) != good, (name, value)


def test_surfaces_are_vertices_and_triangles() -> None:
    vertices, faces = np.zeros((4, 3)), np.zeros((2, 3), dtype=int)
    for value, good in (
        ((vertices, faces), True), ([vertices, faces], True), ((faces, faces), True), ("ab", False),
        ((vertices, faces, faces), False), ((vertices,), False), ((vertices[:, :2], faces), False),
        ((faces, vertices), False), ((vertices, faces[:, :2]), False), ((vertices, faces + 0.0), False),
        (np.zeros((2, 4, 3)), False), (np.zeros((2, 4, 3), dtype=int), False),
    ):  # fmt: skip
        assert kinds._is_surface(value) == good


def test_twists_of_cuts_are_planar() -> None:
    cut = parts(CLAIMS["OutlineCut"]())
    assert refused(kinds._check_cut, SimpleNamespace(**cut)) == ""
    for name, columns in ("reached", 3), ("boxes", 6), ("twists", 3):
        for more in 0, 1:
            words = refused(kinds._check_cut, SimpleNamespace(**cut | {name: np.zeros((2, columns + more))}))
            assert (words == "") == (more == 0)


def test_numbers_that_round_or_overflow_before_rationals_do_are_refused() -> None:
    """One finger pushes up with 100 N at most; whole numbers of 8 bits make 5 times 100 negative."""
    floor = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
    sides = np.array([[0, 0, 1.0]])
    proof = planar(floor, [(0, 100, 0)], [(everything(sides, 1), (0, 0), 0, (0, 2, 0))], sides=sides)
    proof.bound = 1.0
    assert rg.verify(proof).violations == ("proof: the twist of box 0 does not exclude it",)
    for name in ("vertices", "centre_of_mass", "sides", "loads", "ends", "twists"):
        for kind in (np.float16, np.float32, np.int8, np.int64):
            narrow = SimpleNamespace(**vars(proof) | {name: getattr(proof, name).astype(kind)})
            with pytest.raises(InvalidInput, match=f"{name} of a plan must be an array of doubles"):
                rg.verify(narrow)
    for name in ("arcs", "number"):
        for kind in (np.int8, np.uint8, np.uint64):
            narrow = SimpleNamespace(**vars(proof) | {name: getattr(proof, name).astype(kind)})
            with pytest.raises(InvalidInput, match=f"{name} of a plan must be an array of signed whole"):
                rg.verify(narrow)
