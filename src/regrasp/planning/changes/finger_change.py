"""Planning the removal, the addition and the exchange of fingers."""

from collections.abc import Sequence
from typing import Unpack

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import instance
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.asked import Asked
from regrasp.planning.changes.ends import End, state_among
from regrasp.planning.changes.joining import LoadFunction
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import ChangeOptions, takes, with_objective
from regrasp.plans.loads import LoadSeries
from regrasp.plans.transition import Transition


@takes(ChangeOptions)
def plan_removal(
    start: GraspState | Grasp,
    contact: str | int | Sequence[str | int],
    *,
    load: Wrench | LoadSeries | LoadFunction | None = None,
    end: GraspState | None = None,
    objective: str | Objective | Criteria = "angle",
    whole_objective: str | Objective | Criteria = "force",
    idle_from: float | None = None,
    **options: Unpack[ChangeOptions],
) -> Transition:
    """Forces over time that take one finger away while the object stays in equilibrium (Eq. 1-3).

    The path objective ``change`` is the least total change, by the time function, so that Eq. 1-3 is the
    answer where nothing bends it; ``effort`` the least sum of squares over time; ``peak`` the least largest
    force; ``force`` the widest least force margin of the fingers that stay, then the least change. How much
    given forces were balanced is in ``record.balancing``.

    The path is the straight one of Eq. 1-3 where the load is constant and it keeps every demand; else it is a
    ``SampledPath`` by a convex program. ``record.path`` says which.

    Args:
        start: the state to leave from; or a grasp, whose state is then chosen under ``load``. A state chosen
            under ``max_force`` keeps it, unless another is given.
        contact: the finger that leaves, by name or index; or several, which leave together.
        load: object frame [N, N m]: constant, a ``LoadSeries``, or a function of time [s] that returns a
            ``Wrench``; it is sampled at ``instants`` and taken as linear between them (``verify(plan,
            load=...)`` bounds the difference).
        end: the state without it, of the whole grasp or of the remaining contacts; chosen if not given.
        objective: what the state without the finger is chosen for.
        whole_objective: what the state with it is chosen for. The widest force margin, ``force``, gives every
            finger work; the others may leave one idle. ``Criteria`` hold limits of their own for that state;
            the path between keeps the looser ones.
        idle_from: time from which the leaving finger carries no force [s]; the end if not given.
        options

    Raises:
        Infeasible: With the escape twist where the fingers cannot hold the load, or with the limit that no
            path keeps.
        InvalidInput: For given states that are no equilibrium inside the cones.
    """
    asked = Asked.of(start, load, objective, options, idle_from=idle_from)
    grasp, criteria = asked.grasp, asked.criteria
    gone = _places(grasp, contact)
    given_end = None if end is None else state_among(end, grasp, asked.last, gone, "end")
    whole = End("start", asked.first, asked.state, with_objective(criteria, whole_objective), ())
    rest = End("end", asked.last, given_end, criteria, gone)
    return asked.joined(grasp, whole, rest)


@takes(ChangeOptions)
def plan_addition(
    start: GraspState | Grasp,
    contact: Contact | Sequence[Contact],
    *,
    load: Wrench | LoadSeries | LoadFunction | None = None,
    end: GraspState | None = None,
    objective: str | Objective | Criteria = "angle",
    whole_objective: str | Objective | Criteria = "force",
    idle_until: float | None = None,
    **options: Unpack[ChangeOptions],
) -> Transition:
    """Forces over time that bring one finger in: the removal of that finger, run backwards.

    Everything else, and what is raised, is as for ``plan_removal``.

    Args:
        start: the state of the fingers that hold the object; or their grasp, whose state is then chosen.
        contact: where the new finger touches; or several contacts, for fingers that arrive together.
        load: as for ``plan_removal`` [N, N m].
        end: the state of all contacts, the new ones last; chosen by ``whole_objective`` if not given.
        objective: what the state without the new fingers is chosen for.
        whole_objective: what the state with them is chosen for.
        idle_until: time up to which the new finger carries no force [s]; the start if not given.
        options
    """
    arriving = _contacts(contact)
    asked = Asked.of(start, load, objective, options, idle_until=idle_until)
    before, criteria = asked.grasp, asked.criteria
    grasp = Grasp((*before, *arriving))
    if end is not None:
        instance(end, "end", GraspState)
    if end is not None and (end.grasp != grasp or end.load != asked.last):
        raise InvalidInput(
            f"end must be a state of the start's contacts and the new one, in that order "
            f"({', '.join(grasp.names)}), under the same load; got {shown(end)}"
        )
    new = tuple(range(len(before), len(grasp)))
    rest = End("start", asked.first, asked.state, criteria, new)
    whole = End("end", asked.last, end, with_objective(criteria, whole_objective), ())
    return asked.joined(grasp, rest, whole)


@takes(ChangeOptions)
def plan_exchange(
    start: GraspState | Grasp,
    leaving: str | int | Sequence[str | int],
    arriving: Contact | Sequence[Contact],
    *,
    load: Wrench | LoadSeries | LoadFunction | None = None,
    end: GraspState | None = None,
    objective: str | Objective | Criteria = "angle",
    start_objective: str | Objective | Criteria | None = None,
    idle_from: float | None = None,
    idle_until: float | None = None,
    **options: Unpack[ChangeOptions],
) -> Transition:
    """Forces over time in which one finger takes over from another: both touch, one leaves, one arrives.

    Everything else, and what is raised, is as for ``plan_removal``.

    Args:
        start: the state of the fingers that hold the object; or their grasp, whose state is then chosen.
        leaving: the finger that leaves, by name or index, or several.
        arriving: where the new finger touches, or several contacts.
        load: as for ``plan_removal`` [N, N m].
        end: the state without the leaving finger, the new ones last, of these contacts or of all in play;
            chosen if not given.
        objective: what the state at the end is chosen for.
        start_objective: what the state at the start is chosen for; the same if not given.
        idle_from: time from which the leaving finger carries no force [s]; the end if not given.
        idle_until: time up to which the new finger carries no force [s]; the start if not given.
        options
    """
    new = _contacts(arriving)
    asked = Asked.of(start, load, objective, options, idle_from=idle_from, idle_until=idle_until)
    before, criteria = asked.grasp, asked.criteria
    gone = _places(before, leaving)
    grasp = Grasp((*before, *new))
    given_end = None if end is None else state_among(end, grasp, asked.last, gone, "end")
    chosen_for = criteria if start_objective is None else with_objective(criteria, start_objective)
    held = End("start", asked.first, asked.state, chosen_for, tuple(range(len(before), len(grasp))))
    after = End("end", asked.last, given_end, criteria, gone)
    return asked.joined(grasp, held, after)


def _places(grasp: Grasp, contacts: str | int | Sequence[str | int]) -> tuple[int, ...]:
    """The places of the fingers that leave; one at least stays."""
    if isinstance(contacts, (str, int)) or not isinstance(contacts, Sequence):
        return _but_all(grasp, grasp.index(contacts))
    places = [grasp.index(contact) for contact in contacts]
    if not places or len(set(places)) < len(places):
        raise InvalidInput(
            f"the fingers that leave must be one or more different ones, got {shown(contacts)}"
        )
    return _but_all(grasp, *places)


def _but_all(grasp: Grasp, *places: int) -> tuple[int, ...]:
    """The places, if one contact at least is not among them."""
    if len(places) == len(grasp.contacts):
        last = ", ".join(map(repr, grasp.names))
        raise InvalidInput(f"the last contact{'s' * (len(places) > 1)}, {last}, cannot be taken from a grasp")
    return places


def _contacts(given: Contact | Sequence[Contact]) -> tuple[Contact, ...]:
    """The contacts that arrive."""
    contacts = (given,) if isinstance(given, Contact) else given
    if not isinstance(contacts, Sequence) or not contacts or isinstance(contacts, str):
        raise InvalidInput(f"contact must be the Contact that arrives, got {shown(given)}")
    for contact in contacts:
        if not isinstance(contact, Contact):
            raise InvalidInput(f"contact must be the Contact that arrives, got {shown(contact)}")
    return tuple(contacts)
