"""What ``verify`` needs to know of a plan, whoever made it."""

from typing import Protocol

from regrasp.mechanics.checks import Array
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.robust.stiffness import Stiffness
from regrasp.mechanics.state import GraspState

NEEDED = ("leaving", "arriving", "start", "end", "scaling", "course", "turn", "record")
"""What a transition has, whoever made it."""


class Scaling(Protocol):
    """T(t) as ``verify`` sees it: a B-spline by its control values."""

    @property
    def duration(self) -> float:
        """[s]."""

    @property
    def control(self) -> tuple[float, ...]:
        """Control values, first to last."""


class Course(Protocol):
    """Forces and loads at instants, linear between them."""

    @property
    def times(self) -> Array:
        """(K,) [s]."""

    @property
    def forces(self) -> Array:
        """(K, n, d) [N]."""

    @property
    def loads(self) -> Array:
        """(K, 3) or (K, 6) [N, N m]."""


class Turn(Protocol):
    """Forces at angles of the object; between them the combination of fact 3."""

    @property
    def angles(self) -> Array:
        """(K,) [rad]."""

    @property
    def forces(self) -> Array:
        """(K, n, d) [N], object frame."""

    @property
    def axis(self) -> Array | None:
        """(3,) unit axis in space; None in the plane."""

    @property
    def middles(self) -> Array | None:
        """(K - 1, n, d) [N] between the angles, where a part of the load does not turn; None elsewhere."""


class Choice(Protocol):
    """How an end was chosen."""

    @property
    def end(self) -> str:
        """``start`` or ``end``."""

    @property
    def force_limits(self) -> tuple[float, ...]:
        """[N], infinite for none."""


class Withstood(Protocol):
    """What a plan says that it withstands at every instant."""

    @property
    def disturbance(self) -> LoadSet | None:
        """Deviations of the load; None for none."""

    @property
    def stiffness(self) -> Stiffness:
        """Of the fingers, one number or rows by contact [N/m]."""

    @property
    def early_loss(self) -> bool:
        """Whether a finger that leaves or arrives may lose contact early."""


class Record(Protocol):
    """What a plan says it keeps to; ``withstands``, a ``Withstood`` or None, besides if it says that."""

    @property
    def reserve(self) -> float:
        """The fraction of every friction coefficient kept back."""

    @property
    def balancing(self) -> float:
        """The largest change of a given force [N]."""

    @property
    def choices(self) -> tuple[Choice, ...]:
        """The ends that were not given."""

    @property
    def rate_limits(self) -> tuple[float, ...]:
        """(n,) [N/s], or empty."""

    @property
    def least_normals(self) -> tuple[float, ...]:
        """(n,) [N], or empty."""


class Plan(Protocol):
    """What ``verify`` needs to know of a transition."""

    @property
    def leaving(self) -> tuple[str, ...]:
        """Names of the fingers that leave: they carry no force at the end."""

    @property
    def arriving(self) -> tuple[str, ...]:
        """Names of the fingers that arrive: they carry none at the start."""

    @property
    def turn(self) -> "Turn | None":
        """States on the way of a turning object; None where it keeps its orientation."""

    @property
    def start(self) -> GraspState:
        """The state at t = 0."""

    @property
    def end(self) -> GraspState:
        """The state at t = duration."""

    @property
    def scaling(self) -> Scaling:
        """The time function between them."""

    @property
    def course(self) -> Course | None:
        """Instants that the forces go through; None for the straight path."""

    @property
    def record(self) -> Record:
        """What the plan says of itself."""

    def forces(self, t: Array) -> Array:
        """(m, n, d) forces at m times [N]; set-points are compared with them."""
