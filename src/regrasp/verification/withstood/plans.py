"""What a plan is asked to withstand besides its load, and what of it breaks."""

from dataclasses import dataclass

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, finite, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.robust.moved import moved
from regrasp.mechanics.robust.stiffness import Stiffness, checked_stiffness
from regrasp.mechanics.wrench import Wrench
from regrasp.verification.protocols import Plan, Withstood
from regrasp.verification.withstood.contacts import Body
from regrasp.verification.withstood.judge import Judge


@dataclass(frozen=True)
class Asked:
    """What a plan must withstand besides its load.

    disturbance: deviations of the load, None for none. friction: the factor on coefficients. positions:
    (m, n, d - 1) contacts off along their tangents [m], each row by itself. surface: (n,) its curvature
    [1/m].
    """

    disturbance: LoadSet | None
    stiffness: Stiffness
    friction: float
    positions: Array | None
    surface: Array | None
    early_loss: bool

    @classmethod
    def of(
        cls,
        grasp: Grasp,
        disturbance: LoadSet | None,
        stiffness: ArrayLike | None,
        friction: float | None,
        position: ArrayLike | None,
        surface: ArrayLike | None,
        early_loss: bool,
    ) -> "Asked | None":
        """What a call asks of the plan of a grasp; None for nothing."""
        if disturbance is not None and (
            not isinstance(disturbance, LoadSet) or disturbance.dimension != grasp.dimension
        ):
            raise InvalidInput(
                f"disturbance must be a LoadSet of dimension {grasp.dimension}, got {shown(disturbance)}"
            )
        if not isinstance(early_loss, bool):
            raise InvalidInput(f"early_loss must be True or False, got {shown(early_loss)}")
        factor = 1.0 if friction is None else number(friction, "friction", least=0)
        n, across = len(grasp), grasp.dimension - 1
        offsets = None
        if position is not None:
            given = finite(position, "position")
            if given.size == 0 or given.shape[-across:] != (n, across)[:across]:
                wanted = "(n,) or (m, n)" if across == 1 else "(n, 2) or (m, n, 2)"
                raise InvalidInput(f"position must have shape {wanted} with n = {n}, got {given.shape}")
            offsets = given.reshape(-1, n, across)
        curved = finite(np.zeros(n) if surface is None else surface, "surface")
        if curved.shape not in ((), (n,)):
            raise InvalidInput(f"surface must be one curvature or {n}, got shape {curved.shape}")
        springs = checked_stiffness(stiffness)
        if disturbance is None and friction is None and position is None and not early_loss:
            if stiffness is not None or surface is not None:
                raise InvalidInput(
                    "stiffness and surface say how a grasp answers to what is asked of it: give disturbance, "
                    "position, friction or early_loss, too"
                )
            return None
        return cls(disturbance, springs, factor, offsets, np.broadcast_to(curved, n), early_loss)

    @property
    def words(self) -> str:
        """What must be withstood."""
        said = [] if self.disturbance is None else [f"every deviation of the {self.disturbance}"]
        said += [f"{self.friction:.6g} times the friction"] if self.friction != 1 else []
        if self.positions is not None:
            ways = f", in {len(self.positions)} ways" if len(self.positions) > 1 else ""
            said.append(f"contacts off along their tangents{ways}")
        said += ["the early loss of a finger that leaves or arrives"] if self.early_loss else []
        return ", with ".join(said)

    def covers(self, other: "Asked") -> bool:
        """Whether what another asks of a plan's own contacts is asked here, too."""
        return (
            (self.disturbance, self.stiffness) == (other.disturbance, other.stiffness)
            and self.positions is None
            and self.friction <= other.friction
            and self.early_loss >= other.early_loss
        )


def check_promised(plan: Plan, asked: Asked | None) -> tuple[list[str], str]:
    """What a plan does not withstand of what its record says, unless ``asked`` covers that; and in words."""
    said: Withstood | None = getattr(plan.record, "withstands", None)
    if said is None:
        return [], ""
    try:
        promised = Asked.of(
            plan.start.grasp, said.disturbance, said.stiffness, 1.0, None, None, said.early_loss
        )
        assert promised is not None
        if asked is not None and asked.covers(promised):
            return [], ""
        return [f"record: {violation}" for violation in check_withstood(plan, promised)], promised.words
    except InvalidInput as error:
        return [f"record: {error}"], ""


def check_withstood(plan: Plan, asked: Asked) -> list[str]:
    """Which fingers do not withstand what is asked, when and for which member."""
    grasp = plan.start.grasp
    zero = Wrench.from_vector(np.zeros(len(grasp.matrix)))
    loads = LoadSet.hull([zero]) if asked.disturbance is None else asked.disturbance
    if plan.turn is not None and not loads.contains(zero):
        raise InvalidInput("a disturbance of a turn must hold the deviation zero, besides others")
    answering = loads is asked.disturbance or asked.positions is not None or asked.early_loss
    body, springs, broken = Body(loads), asked.stiffness if answering else None, list[str]()
    offsets = [None] if asked.positions is None else list(asked.positions)
    for k, offset in enumerate(offsets):
        where = "" if len(offsets) == 1 else f", contacts off as in row {k}"
        off = grasp if offset is None else moved(grasp, offset, np.asarray(asked.surface))
        judge = Judge(plan, off, body, asked.friction, springs, asked.early_loss)
        broken += [f"{violation}{where}" for violation in judge.violations()]
    return broken
