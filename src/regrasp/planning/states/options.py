"""The keyword arguments that many verbs share, each spelled, defaulted and described in one place.

A verb takes ``**options: Unpack[StateOptions]``, is decorated with ``takes(StateOptions)``, and so has their
names in its signature and their words in its docstring; scenario keys take default and description from
``described``.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache, lru_cache, wraps
from inspect import Parameter, Signature, cleandoc, signature
from re import sub
from textwrap import fill
from typing import Annotated, Any, NamedTuple, ParamSpec, TypedDict, TypeVar, get_args, get_type_hints

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import ArrayLike
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.reserve import RESERVE
from regrasp.planning.states.criteria import PEAK_RATIO, Criteria
from regrasp.planning.states.objectives import Objective, objective_of
from regrasp.plans.timing import TimeScaling

BALANCE_TOLERANCE = 1e-3
INSTANTS = 101
WIDTH = 100
"""Columns of a docstring's words."""

P = ParamSpec("P")
R = TypeVar("R")


class Option(NamedTuple):
    """The default of an option and what it is, shape and unit included."""

    default: Any
    words: str


_DISTURBANCE = Option(
    None,
    "load deviations that the forces withstand on top of the load when the fingers answer with their "
    "stiffness; for objective 'wrench' the set whose factor is made widest (a unit ball, torque divided by "
    "the grasp's size)",
)
_STIFFNESS = Option(
    None, "of the fingers that answer, a number or an array by contact as in Criteria [N/m]; all alike"
)


class LimitOptions(TypedDict, total=False):
    """Under which limits states are chosen; what they mean exactly stands in ``Criteria``."""

    max_force: Annotated[float | None, Option(None, "limit on every force besides the contacts' own [N]")]
    peak_ratio: Annotated[
        float,
        Option(
            PEAK_RATIO,
            "where a contact has no limit, objectives that could squeeze without end limit every force to "
            "this multiple of the least peak force that holds the load [-]",
        ),
    ]
    reserve: Annotated[
        float, Option(RESERVE, "fraction of every friction coefficient that planning keeps back [-]")
    ]


class StateOptions(LimitOptions, total=False):
    """How one state is chosen."""

    min_normal: Annotated[
        ArrayLike | None,
        Option(None, "least normal force of every finger [N], or (n,) one for each contact"),
    ]
    disturbance: Annotated[LoadSet | None, _DISTURBANCE]
    stiffness: Annotated[ArrayLike | None, _STIFFNESS]

    method: Annotated[
        str,
        Option(
            "auto",
            "'closed-form' (two planar contacts), a back end's name, or 'auto': the closed form where it "
            "exists, else Clarabel",
        ),
    ]
    facets: Annotated[
        int | None,
        Option(
            None,
            "sides of the inner polygon that stands for every circle, for back ends without second-order "
            "cones: in the plane of a force limit and of 'peak', in space of the friction cones, too; safe, "
            "limits lose up to the fraction 1 - cos(pi / facets)",
        ),
    ]


class PlanOptions(LimitOptions, total=False):
    """How the ends of a plan are chosen, and its clock."""

    min_normal: Annotated[float | None, Option(None, "least normal force of the fingers that stay [N]")]
    disturbance: Annotated[LoadSet | None, _DISTURBANCE]
    stiffness: Annotated[ArrayLike | None, _STIFFNESS]

    method: Annotated[str, Option("auto", "'auto', 'closed-form' or a back end's name, as for choose_state")]
    facets: Annotated[
        int | None, Option(None, "sides of polygons in the place of circles, as for choose_state")
    ]
    duration: Annotated[float | None, Option(None, "of the whole plan [s]; 1 unless something else sets it")]
    scaling: Annotated[TimeScaling | None, Option(None, "a whole time function, in the place of a duration")]
    balance_tolerance: Annotated[
        float,
        Option(
            BALANCE_TOLERANCE,
            "given forces may change by this fraction of the largest to reach exact equilibrium [-]",
        ),
    ]


class ChangeOptions(PlanOptions, total=False):
    """How a finger leaves or arrives."""

    rate_limit: Annotated[
        ArrayLike | None,
        Option(
            None,
            "fastest change |f_i'(t)| of the forces, a number or one for each contact [N/s]; without a "
            "duration the shortest is used, with one the path bends where the straight one is too fast",
        ),
    ]
    path_objective: Annotated[
        str | None,
        Option(
            None,
            "what the path is planned for, instant by instant: 'change', 'effort', 'peak' or 'force'; "
            "Eq. 1-3 if not given and enough",
        ),
    ]
    early_loss: Annotated[
        bool,
        Option(
            False,
            "whether forces, and the disturbance if any, are withstood, too, when a finger that leaves or "
            "arrives loses contact early",
        ),
    ]
    instants: Annotated[int, Option(INSTANTS, "instants of a path that is not straight, at least 3")]


@cache
def described(options: type) -> Mapping[str, tuple[Any, Option]]:
    """Type, default and words of every option of a set, by name, in order."""
    hints = get_type_hints(options, include_extras=True)
    return {name: (get_args(hint)[0], get_args(hint)[1]) for name, hint in hints.items()}


def takes(options: type) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """The decorator of a verb that ends in ``**options``: these show in its signature and docstring.

    Whatever else is given raises ``TypeError``, as for any function.
    """

    def decorated(verb: Callable[P, R]) -> Callable[P, R]:
        own = [p for p in signature(verb).parameters.values() if p.kind is not Parameter.VAR_KEYWORD]
        names = {p.name for p in own}
        more = {name: entry for name, entry in described(options).items() if name not in names}
        known = frozenset((*names, *more))

        @wraps(verb)
        def checked(*args: P.args, **given: P.kwargs) -> R:
            if not known.issuperset(given):
                unknown = next(name for name in given if name not in known)
                raise TypeError(
                    f"{verb.__name__}() got an unexpected keyword argument {shown(unknown)}; it takes "
                    f"{', '.join(more)}"
                )
            try:
                return verb(*args, **given)
            except Infeasible as refusal:
                from regrasp.planning.states.refusals.helping import Call

                arguments = signature(verb).bind(*args, **given).arguments
                refusal.helped(Call(verb, arguments, known, refusal).what_helps)
                raise

        extra = [
            Parameter(name, Parameter.KEYWORD_ONLY, default=option.default, annotation=kind)
            for name, (kind, option) in more.items()
        ]
        checked.__signature__ = Signature(  # type: ignore[attr-defined]
            [*own, *extra], return_annotation=signature(verb).return_annotation
        )
        checked.__doc__ = _with_words(cleandoc(verb.__doc__ or ""), more)
        return checked

    return decorated


def _with_words(text: str, options: Mapping[str, tuple[Any, Option]]) -> str:
    """A docstring with the words of options in the place of the line ``options`` of its ``Args``."""
    entries = [
        fill(
            f"{name}: {option.words}; {option.default!r} if not given.",
            WIDTH,
            initial_indent=" " * 4,
            subsequent_indent=" " * 8,
            break_on_hyphens=False,
        )
        for name, (_, option) in options.items()
    ]
    return sub(r"(?m)^    options$", lambda _: "\n".join(entries), text)


_LIMITS = (*LimitOptions.__annotations__, "min_normal", "disturbance", "stiffness", "early_loss")


def criteria_of(objective: "str | Objective | Criteria", options: Mapping[str, Any]) -> Criteria:
    """The criteria of a call: as they were given, or of a word or an objective and the limits given."""
    given = tuple(
        [(name, options[name], type(options[name])) for name in _LIMITS if name in options] if options else ()
    )
    if isinstance(objective, Criteria):
        if given:
            raise InvalidInput(
                f"the Criteria given hold every limit; leave out {', '.join(name for name, *_ in given)}"
            )
        return objective
    try:
        return _known(objective, given)
    except TypeError:  # not hashable: the check says what is wrong
        return Criteria(objective, **{name: value for name, value, _ in given})


@lru_cache(maxsize=256, typed=True)
def _known(objective: "str | Objective", limits: tuple[tuple[str, Any, type], ...]) -> Criteria:
    """Checked once for the same arguments, types included: planning takes microseconds."""
    return Criteria(objective, **{name: value for name, value, _ in limits})


def with_objective(criteria: Criteria, objective: "str | Objective | Criteria") -> Criteria:
    """The same limits for another objective; ``Criteria`` hold their own."""
    if isinstance(objective, Criteria):
        return objective
    return _for(criteria, objective if isinstance(objective, str) else objective_of(objective))


@lru_cache(maxsize=256)
def _for(criteria: Criteria, objective: "str | Objective") -> Criteria:
    return replace(criteria, objective=objective_of(objective))
