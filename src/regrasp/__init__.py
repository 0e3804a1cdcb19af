"""regrasp: contact forces while a grasp changes, planned, proven and explained."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from regrasp.errors import Infeasible, InvalidInput, RegraspError, SolverFailed, SolverUnavailable
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import Margins
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.batch import best_squeezes, locus_intervals
from regrasp.planning.change import plan_addition, plan_removal
from regrasp.planning.choice import choose_state
from regrasp.planning.criteria import ChosenState
from regrasp.planning.loads import LoadSeries
from regrasp.planning.locus import EquilibriumLocus
from regrasp.planning.rotation import plan_rotation
from regrasp.planning.sampled import SampledTransition
from regrasp.planning.timing import TimeScaling
from regrasp.planning.transition import Transition
from regrasp.planning.turning import TurningTransition
from regrasp.verification import Verification, verify

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh
    from regrasp.outline.outline import Outline
    from regrasp.planning.bottleneck import Bottleneck, bottleneck
    from regrasp.planning.directions import HeldDirections, held_directions
    from regrasp.planning.held_sphere import HeldSphere, held_sphere
    from regrasp.planning.obstacle import RegraspObstacle
    from regrasp.planning.pyramid_loss import PyramidLosses, pyramid_losses
    from regrasp.planning.regrasp_plan import RegraspPlan
    from regrasp.planning.regrasp_problem import RegraspProblem
    from regrasp.planning.regrasp_weights import RegraspWeights
    from regrasp.planning.regrasping import plan_regrasp, plan_regrasps
    from regrasp.planning.sensitivity import Sensitivity, sensitivity
    from regrasp.planning.space_plan import SpaceRegraspPlan
    from regrasp.planning.space_problem import SpaceRegraspProblem
    from regrasp.planning.squeeze_locus import SqueezeLocus

__version__ = "0.1.0"

# Loaded when they are asked for, so that `import regrasp` stays fast: whole regrasps, shapes and surveys.
_LATER = {
    "Mesh": "regrasp.mesh.mesh",
    "Outline": "regrasp.outline.outline",
    "Bottleneck": "regrasp.planning.bottleneck",
    "bottleneck": "regrasp.planning.bottleneck",
    "HeldDirections": "regrasp.planning.directions",
    "held_directions": "regrasp.planning.directions",
    "HeldSphere": "regrasp.planning.held_sphere",
    "held_sphere": "regrasp.planning.held_sphere",
    "RegraspObstacle": "regrasp.planning.obstacle",
    "PyramidLosses": "regrasp.planning.pyramid_loss",
    "pyramid_losses": "regrasp.planning.pyramid_loss",
    "RegraspPlan": "regrasp.planning.regrasp_plan",
    "RegraspProblem": "regrasp.planning.regrasp_problem",
    "RegraspWeights": "regrasp.planning.regrasp_weights",
    "plan_regrasp": "regrasp.planning.regrasping",
    "plan_regrasps": "regrasp.planning.regrasping",
    "Sensitivity": "regrasp.planning.sensitivity",
    "sensitivity": "regrasp.planning.sensitivity",
    "SpaceRegraspPlan": "regrasp.planning.space_plan",
    "SpaceRegraspProblem": "regrasp.planning.space_problem",
    "SqueezeLocus": "regrasp.planning.squeeze_locus",
}

__all__ = [
    "Bottleneck",
    "ChosenState",
    "Contact",
    "EquilibriumLocus",
    "EscapeTwist",
    "Grasp",
    "GraspState",
    "HeldDirections",
    "HeldSphere",
    "Infeasible",
    "InvalidInput",
    "LoadSeries",
    "Margins",
    "Mesh",
    "Outline",
    "PyramidLosses",
    "RegraspError",
    "RegraspObstacle",
    "RegraspPlan",
    "RegraspProblem",
    "RegraspWeights",
    "SampledTransition",
    "Sensitivity",
    "SolverFailed",
    "SolverUnavailable",
    "SpaceRegraspPlan",
    "SpaceRegraspProblem",
    "SqueezeLocus",
    "TimeScaling",
    "Transition",
    "TurningTransition",
    "Verification",
    "Wrench",
    "best_squeezes",
    "bottleneck",
    "choose_state",
    "held_directions",
    "held_sphere",
    "locus_intervals",
    "plan_addition",
    "plan_regrasp",
    "plan_regrasps",
    "plan_removal",
    "plan_rotation",
    "pyramid_losses",
    "sensitivity",
    "verify",
]


def __getattr__(name: str) -> Any:
    if name in _LATER:
        value = getattr(import_module(_LATER[name]), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
