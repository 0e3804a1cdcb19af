"""What settings, refusals and remedies read of a regrasp problem."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import ArrayLike
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.wrench import Wrench
from regrasp.outline import Outline
from regrasp.planning.holds.graphs import AnyGraph
from regrasp.planning.holds.weights import RegraspWeights
from regrasp.planning.regrasps.settings.setting import Setting
from regrasp.planning.states.criteria import Criteria

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh


def without_limits(contacts: Iterable[Contact]) -> tuple[Contact, ...]:
    """The contacts without linear limits, of which the holds are bounds."""
    return tuple(c if c.limits is None else c.changed(limits=None) for c in contacts)


class Asked(Protocol):
    """What is read of a ``RegraspProblem``, where its fields are described."""

    @property
    def outline(self) -> "Outline | Mesh":
        """An outline or a mesh."""

    @property
    def load(self) -> Wrench:
        """Before the object turns."""

    @property
    def friction(self) -> float:
        """Of the candidates [-]."""

    @property
    def orientations(self) -> int | None:
        """How many are tried."""

    @property
    def goal_orientation(self) -> float:
        """In the plane [rad]."""

    @property
    def goal_rotation(self) -> ArrayLike | None:
        """In space."""

    @property
    def candidates(self) -> int | ArrayLike | None:
        """How many points are spread over the shape, or where they are."""

    @property
    def facets(self) -> int | None:
        """Of inner pyramids."""

    @property
    def seed(self) -> int:
        """Of the candidates on a mesh."""

    @property
    def largest_turn(self) -> float:
        """Of one step [rad]."""

    @property
    def least_margin(self) -> float:
        """That every hold must have [rad]."""

    @property
    def min_distance(self) -> float:
        """Between two fingers [m]."""

    @property
    def keep(self) -> Any:
        """A filter of holds."""

    @property
    def arcs(self) -> Any:
        """Where fingers may touch."""

    @property
    def one_finger(self) -> bool:
        """Whether one finger of a hold may carry the load alone."""

    @property
    def min_normal(self) -> float | None:
        """With which fingers push [N]; None for a share of the load."""

    @property
    def max_force(self) -> float | None:
        """Of every finger [N]."""

    @property
    def peak_ratio(self) -> float:
        """As for ``choose_state`` [-]."""

    @property
    def reserve(self) -> float:
        """As for ``choose_state`` [-]."""

    @property
    def judges_holds(self) -> bool:
        """Whether margins of the graph are bounds, for it knows no linear limits, nor what is withstood."""

    @property
    def kept_pairs(self) -> NDArray[np.bool_]:
        """(P, O) whether pairs of the plane may keep these."""

    @property
    def states(self) -> str:
        """Each or joint."""

    @property
    def step_duration(self) -> float:
        """[s]."""

    @property
    def weights(self) -> RegraspWeights | None:
        """Of costs, or None."""

    @property
    def setting(self) -> Setting:
        """The plane or space."""

    @property
    def graph(self) -> AnyGraph:
        """The holds."""

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts of both ends, then the candidates."""

    @property
    def places(self) -> tuple[tuple[int, ...], tuple[int, ...], int]:
        """The start's and the goal's contacts, and the place of the last orientation."""

    @property
    def allowed(self) -> NDArray[np.bool_] | None:
        """(fingers, V) which finger may touch which contact, or None."""

    @property
    def is_exact(self) -> bool:
        """Whether all orientations are looked at."""

    @property
    def criteria(self) -> Criteria:
        """Objective and limits."""

    def graph_on(self, contacts: Iterable[Contact]) -> AnyGraph:
        """The holds of other contacts."""

    def allowing(self, force: float) -> "Asked":
        """The same with at least this force [N] where it is limited."""

    def asking(self, min_normal: float) -> "Asked":
        """The same with a least normal force [N]."""

    def plans(self, extra: int = 0) -> Any:
        """Plans, or ``Infeasible``."""
