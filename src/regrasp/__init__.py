"""regrasp: contact forces while a grasp changes, planned, proven and explained."""

from regrasp.errors import Infeasible, InvalidInput, RegraspError, SolverFailed, SolverUnavailable
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import Margins
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline
from regrasp.planning.batch import best_squeezes, locus_intervals
from regrasp.planning.change import plan_addition, plan_removal
from regrasp.planning.choice import choose_state
from regrasp.planning.criteria import ChosenState
from regrasp.planning.directions import HeldDirections, held_directions
from regrasp.planning.held_sphere import HeldSphere, held_sphere
from regrasp.planning.loads import LoadSeries
from regrasp.planning.locus import EquilibriumLocus
from regrasp.planning.pyramid_loss import PyramidLosses, pyramid_losses
from regrasp.planning.regrasp_plan import RegraspPlan
from regrasp.planning.regrasping import plan_regrasp, plan_regrasps
from regrasp.planning.rotation import plan_rotation
from regrasp.planning.sampled import SampledTransition
from regrasp.planning.sensitivity import Sensitivity, sensitivity
from regrasp.planning.squeeze_locus import SqueezeLocus
from regrasp.planning.timing import TimeScaling
from regrasp.planning.transition import Transition
from regrasp.planning.turning import TurningTransition
from regrasp.verification import Verification, verify

__version__ = "0.1.0"

__all__ = [
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
    "RegraspPlan",
    "SampledTransition",
    "Sensitivity",
    "SolverFailed",
    "SolverUnavailable",
    "SqueezeLocus",
    "TimeScaling",
    "Transition",
    "TurningTransition",
    "Verification",
    "Wrench",
    "best_squeezes",
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
