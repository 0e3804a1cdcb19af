"""Regions on flat faces in space: every choice within holds, wider ones fail, what is spoiled is seen."""

from dataclasses import replace

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
from regrasp.planning.placement.laws import LAWS
from values import WEIGHT, on_faces

pytestmark = pytest.mark.laws


def holds(points: list[np.ndarray], limit: float) -> bool:
    grasp = rg.Grasp(rg.Contact(p, [0, 0, 1], 0.3, name=f"F{i}") for i, p in enumerate(points))
    try:
        rg.choose_state(grasp, WEIGHT, "peak", max_force=limit)
    except rg.Infeasible:
        return False
    return True


def test_forces_within_limits_of_the_contacts() -> None:
    regions = on_faces()
    for factor, ok in ((1.0, True), (0.999, False)):
        limit = factor * regions.max_force
        verdict = rg.verify(
            replace(regions, grasp=rg.Grasp(c.changed(max_force=limit) for c in regions.grasp))
        )
        assert verdict.ok is ok
    assert "above the max_force of" in str(verdict)


def test_every_choice_within_regions_holds_and_not_within_wider_ones() -> None:
    regions = on_faces()
    verdict = rg.verify(regions)
    assert verdict.ok
    assert str(verdict).startswith("verified in exact arithmetic: ")
    assert 0 <= verdict.least_cone_slack <= 0.09  # mu^2
    assert regions.radius > 0.02
    rng = np.random.default_rng(3)
    fails = {1.0: 0, 4.0: 0}
    for factor in fails:
        for _ in range(60):
            shares = [rng.dirichlet(np.full(len(p), 0.2)) for p in regions.patches]
            points = [
                c.position + factor * (s @ p - c.position)
                for s, p, c in zip(shares, regions.patches, regions.grasp, strict=True)
            ]
            fails[factor] += not holds(points, regions.max_force)
    assert fails[1.0] == 0
    assert fails[4.0] > 5


def test_the_least_radius_is_that_of_all_and_products_of_areas_are_larger() -> None:
    assert rg.contact_regions(on_faces().shape, on_faces().grasp, WEIGHT, widest="least") == on_faces()
    assert on_faces().radii.min() == on_faces().radius
    box = on_faces().shape
    grasp = rg.Grasp(
        box.contact_at([x, y, -0.25], friction=0.3) for x, y in ((-0.15, -0.1), (0.15, -0.1), (0, 0.03))
    )
    together, product_of = (rg.contact_regions(box, grasp, WEIGHT, widest=w) for w in ("together", "product"))
    assert area(product_of) > 1.2 * area(together)
    assert product_of.radius == product_of.radii.min() <= together.radius
    assert rg.verify(product_of).ok
    rng = np.random.default_rng(3)
    for _ in range(40):
        assert holds(
            [rng.dirichlet(np.full(len(p), 0.2)) @ p for p in product_of.patches], product_of.max_force
        )
    for wrong, words in (
        (replace(product_of, radii=together.radii), "does not end there"),
        (replace(product_of, radius=together.radius), "radius of all"),
        (replace(product_of, forces=together.forces), "equilibrium"),
    ):
        assert any(words in v for v in rg.verify(wrong).violations), (words, rg.verify(wrong))


def area(regions: rg.FaceRegions) -> float:
    """Product of the areas of polygons in planes z."""
    x, y = np.array([p.T[:2] for p in regions.patches]).transpose(1, 0, 2)
    return float(abs(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1).prod())


def test_regions_are_discs_but_where_faces_end() -> None:
    box = rg.Mesh.box(0.4, 0.3, 0.5)
    places = [[-0.1, -0.08, -0.25], [0.1, -0.08, -0.25], [0, 0.149, -0.25]]  # 1 mm from an edge
    regions = rg.contact_regions(box, rg.Grasp(box.contact_at(p, friction=0.5) for p in places), WEIGHT)
    assert rg.verify(regions).ok
    assert regions.radius > 0.01
    assert regions.patches[2][:, 1].max() == pytest.approx(0.15)
    assert (np.abs(np.concatenate(regions.patches)[:, :2]) <= [0.2 + 1e-12, 0.15 + 1e-12]).all()
    assert (regions.alone >= regions.radius).all()


def test_units_and_frames_change_nothing_else() -> None:
    regions = on_faces()
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    length, force = 1e-3, 1e4
    vertices, faces = regions.shape.surface()
    mesh = rg.Mesh(length * vertices @ turn.T, faces)
    grasp = rg.Grasp(rg.Contact(length * turn @ c.position, turn @ c.normal, 0.3) for c in regions.grasp)
    moved = rg.contact_regions(mesh, grasp, rg.Wrench(force * turn @ WEIGHT.force))
    assert moved.radius == pytest.approx(length * regions.radius, rel=0.05)
    assert rg.verify(moved).ok


def test_regions_that_claim_too_much_are_not_verified() -> None:
    good = on_faces()
    wider = tuple(c.position + 1.01 * (p - c.position) for p, c in zip(good.patches, good.grasp, strict=True))
    outside = (good.patches[0] - [0.2, 0, 0], *good.patches[1:])
    for wrong, words in (
        (replace(good, patches=wider), "equilibrium"),
        (replace(good, patches=outside), "around its place"),
        (replace(good, patches=good.patches[:2]), "needs a polygon"),
        (replace(good, radii=2 * good.radii), "does not end there"),
        (replace(good, radius=2 * good.radius), "radius of all"),
        (replace(good, moments=0.5 * good.moments), "lack a torque"),
        (replace(good, max_force=0.5), "above"),
        (replace(good, forces=good.forces[:, 1:]), "missing"),
        (replace(good, shape=rg.Mesh.box(0.4, 0.3, 0.6)), "not on faces"),
    ):
        assert any(words in v for v in rg.verify(wrong).violations), (words, rg.verify(wrong))


def test_what_has_no_regions_is_refused() -> None:
    box, grasp = on_faces().shape, on_faces().grasp
    edge = rg.Grasp([rg.Contact([0.2, 0, -0.25], [0, 0, 1], 0.3), *list(grasp)[1:]])
    off = rg.Grasp([rg.Contact([0.1, 0, 0], [0, 0, 1], 0.3), *list(grasp)[1:]])
    for given, words in (
        ((box, grasp.subset([0, 1]), WEIGHT), "three or four fingers"),
        ((box, edge, WEIGHT), "on an edge of its face"),
        ((box, off, WEIGHT), "no flat face"),
        ((box, grasp, rg.Wrench([0, -1])), "give a load in space"),
        ((rg.Mesh.sphere(1.0), grasp, WEIGHT), "a smooth mesh"),
    ):
        assert words in str(refusal(lambda given=given: rg.contact_regions(*given)))
    with pytest.raises(rg.Infeasible, match="above max_force"):
        rg.contact_regions(box, grasp, WEIGHT, max_force=0.1)


def test_a_load_after_none_is_made_of_columns_of_its_own() -> None:
    from regrasp.closed_form.compiled.patches.patch_corners import corner_forces
    from regrasp.closed_form.compiled.patches.patch_search import spare

    points = np.array([[[1.0, 0, 0]], [[-0.5, 0.8, 0]], [[-0.5, -0.8, 0]]])
    normals, forces = np.tile([0.0, 0, 1], (3, 1)), np.zeros((1, 2, 3, 3))
    loads = np.array([np.zeros(6), [0.1, 0.0, 1, 0, 0, 0]])
    law = (0.5, *LAWS["effort"].codes(), 1e-3)
    corners = np.zeros((1, 3), int)
    assert corner_forces(points, normals, corners, 0, loads, law, 9.0, forces, np.zeros((3, 6)), spare(3)) < 0
    assert np.allclose(forces.sum(axis=2), loads[:, :3], atol=1e-6)


def test_what_is_said_of_regions_ends_where_faces_do() -> None:
    """A finger on a strip 1 wide was said to have a radius larger than the part."""
    found = on_faces()
    assert not found.ended.any()
    assert "end of the face" not in f"{found} {found!r}"
    narrow = found.grasp.positions[0] + (found.patches[0] - found.grasp.positions[0]) / 4
    cut = replace(found, patches=(narrow, *found.patches[1:]))
    assert cut.ended.tolist() == [True, False, False]
    assert cut.reach[0] == np.linalg.norm(narrow - found.grasp.positions[0], axis=1).max() < found.radii[0]
    assert (cut.reach[1:] == found.radii[1:]).all()
    assert all("or to the end of the face" in said for said in (str(cut), repr(cut)))
