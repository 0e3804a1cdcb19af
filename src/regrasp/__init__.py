"""regrasp: contact forces while a grasp changes, planned, proven and explained."""

TYPE_CHECKING = False  # typing has it, and takes longer to load than all of this
if TYPE_CHECKING:
    from regrasp.errors import Infeasible, InvalidInput, RegraspError, SolverFailed, SolverUnavailable
    from regrasp.measures.closure import Closure, closure
    from regrasp.measures.measure import Measure, Quality
    from regrasp.measures.quality import quality
    from regrasp.measures.wrench_ball import WrenchBall, wrench_ball
    from regrasp.measures.wrench_balls import wrench_balls
    from regrasp.mechanics.contact import Contact
    from regrasp.mechanics.escape import EscapeTwist
    from regrasp.mechanics.grasp import Grasp
    from regrasp.mechanics.limits.force_limits import ForceLimits, torque_limits
    from regrasp.mechanics.loads.load_set import LoadSet
    from regrasp.mechanics.margins import Margins
    from regrasp.mechanics.state import GraspState
    from regrasp.mechanics.wrench import Wrench
    from regrasp.mesh.mesh import Mesh
    from regrasp.motions.plan import plan_motions
    from regrasp.motions.regrasps import plan_regrasp
    from regrasp.outline.outline import Outline
    from regrasp.planning.anywhere.deciding import regrasps_on_outline
    from regrasp.planning.anywhere.results import OutlineRegrasps
    from regrasp.planning.changes.finger_change import plan_addition, plan_exchange, plan_removal
    from regrasp.planning.changes.hold import plan_hold
    from regrasp.planning.changes.rotation import plan_rotation
    from regrasp.planning.holds.bottleneck import Bottleneck, bottleneck
    from regrasp.planning.holds.pairs import HoldGraph
    from regrasp.planning.holds.weights import RegraspWeights
    from regrasp.planning.placement.choosing import choose_grasp
    from regrasp.planning.placement.chosen import ChosenGrasp
    from regrasp.planning.placement.maps.placed_values import PlacementMap
    from regrasp.planning.placement.maps.placement_map import placement_map
    from regrasp.planning.placement.regions.asking import contact_regions
    from regrasp.planning.placement.regions.contact_arcs import ContactRegions
    from regrasp.planning.placement.regions.face_patches import FaceRegions
    from regrasp.planning.placement.space.surface_map import SurfaceMap, surface_map
    from regrasp.planning.regrasps.problem import RegraspProblem
    from regrasp.planning.regrasps.verbs import plan_regrasps
    from regrasp.planning.regrasps.why_not import RegraspObstacle
    from regrasp.planning.robustness.batch import BatchTolerances, batch_tolerances
    from regrasp.planning.robustness.least_stiffness import least_stiffness
    from regrasp.planning.robustness.margin_curve import MarginCurve, margin_curve
    from regrasp.planning.robustness.tolerances import Tolerances, tolerances
    from regrasp.planning.states.arrays.many_states import BatchStates, choose_states
    from regrasp.planning.states.batch import best_squeezes, locus_intervals
    from regrasp.planning.states.choosing import choose_state
    from regrasp.planning.states.criteria import ChosenState, Criteria
    from regrasp.planning.states.objectives import ForceCost
    from regrasp.planning.states.two_fingers import EquilibriumLocus
    from regrasp.planning.surveys.extremes.held_centres import HeldCentres, held_centres
    from regrasp.planning.surveys.extremes.largest_load import LargestLoad, largest_load
    from regrasp.planning.surveys.extremes.least_friction import LeastFriction, least_friction
    from regrasp.planning.surveys.held_directions import HeldDirections, held_directions
    from regrasp.planning.surveys.held_sphere import HeldSphere, held_sphere
    from regrasp.planning.surveys.pyramid_loss import PyramidLosses, pyramid_losses
    from regrasp.planning.surveys.sensitivity import Sensitivity, sensitivity
    from regrasp.planning.surveys.squeeze_locus import SqueezeLocus
    from regrasp.plans.carried import carried_load
    from regrasp.plans.loads import LoadSeries
    from regrasp.plans.outline_cut import OutlineCut
    from regrasp.plans.regrasp_cut import RegraspCut
    from regrasp.plans.regrasp_plan import RegraspPlan
    from regrasp.plans.sampled import SampledPath
    from regrasp.plans.straight import StraightPath
    from regrasp.plans.timing import TimeScaling
    from regrasp.plans.transition import Transition
    from regrasp.plans.turning import TurningPath
    from regrasp.studies.study import read_study
    from regrasp.studies.sweeping import sweep
    from regrasp.verification import Verification, verify
__version__ = "0.1.0"

# Loaded when they are asked for: an `import regrasp` is over before an interrupt finds it, and costs nothing.
_LATER = {
    "Infeasible": "regrasp.errors",
    "InvalidInput": "regrasp.errors",
    "RegraspError": "regrasp.errors",
    "SolverFailed": "regrasp.errors",
    "SolverUnavailable": "regrasp.errors",
    "Contact": "regrasp.mechanics.contact",
    "EscapeTwist": "regrasp.mechanics.escape",
    "Grasp": "regrasp.mechanics.grasp",
    "ForceLimits": "regrasp.mechanics.limits.force_limits",
    "torque_limits": "regrasp.mechanics.limits.force_limits",
    "Margins": "regrasp.mechanics.margins",
    "GraspState": "regrasp.mechanics.state",
    "Wrench": "regrasp.mechanics.wrench",
    "choose_state": "regrasp.planning.states.choosing",
    "ChosenState": "regrasp.planning.states.criteria",
    "Criteria": "regrasp.planning.states.criteria",
    "BatchTolerances": "regrasp.planning.robustness.batch",
    "batch_tolerances": "regrasp.planning.robustness.batch",
    "wrench_balls": "regrasp.measures.wrench_balls",
    "BatchStates": "regrasp.planning.states.arrays.many_states",
    "choose_states": "regrasp.planning.states.arrays.many_states",
    "best_squeezes": "regrasp.planning.states.batch",
    "Bottleneck": "regrasp.planning.holds.bottleneck",
    "bottleneck": "regrasp.planning.holds.bottleneck",
    "ChosenGrasp": "regrasp.planning.placement.chosen",
    "choose_grasp": "regrasp.planning.placement.choosing",
    "Closure": "regrasp.measures.closure",
    "closure": "regrasp.measures.closure",
    "contact_regions": "regrasp.planning.placement.regions.asking",
    "ContactRegions": "regrasp.planning.placement.regions.contact_arcs",
    "EquilibriumLocus": "regrasp.planning.states.two_fingers",
    "FaceRegions": "regrasp.planning.placement.regions.face_patches",
    "ForceCost": "regrasp.planning.states.objectives",
    "held_centres": "regrasp.planning.surveys.extremes.held_centres",
    "held_directions": "regrasp.planning.surveys.held_directions",
    "held_sphere": "regrasp.planning.surveys.held_sphere",
    "HeldCentres": "regrasp.planning.surveys.extremes.held_centres",
    "HeldDirections": "regrasp.planning.surveys.held_directions",
    "HeldSphere": "regrasp.planning.surveys.held_sphere",
    "HoldGraph": "regrasp.planning.holds.pairs",
    "largest_load": "regrasp.planning.surveys.extremes.largest_load",
    "LargestLoad": "regrasp.planning.surveys.extremes.largest_load",
    "least_friction": "regrasp.planning.surveys.extremes.least_friction",
    "MarginCurve": "regrasp.planning.robustness.margin_curve",
    "margin_curve": "regrasp.planning.robustness.margin_curve",
    "least_stiffness": "regrasp.planning.robustness.least_stiffness",
    "LeastFriction": "regrasp.planning.surveys.extremes.least_friction",
    "carried_load": "regrasp.plans.carried",
    "plan_hold": "regrasp.planning.changes.hold",
    "LoadSeries": "regrasp.plans.loads",
    "LoadSet": "regrasp.mechanics.loads.load_set",
    "locus_intervals": "regrasp.planning.states.batch",
    "Measure": "regrasp.measures.measure",
    "Mesh": "regrasp.mesh.mesh",
    "Outline": "regrasp.outline.outline",
    "OutlineCut": "regrasp.plans.outline_cut",
    "OutlineRegrasps": "regrasp.planning.anywhere.results",
    "placement_map": "regrasp.planning.placement.maps.placement_map",
    "PlacementMap": "regrasp.planning.placement.maps.placed_values",
    "plan_addition": "regrasp.planning.changes.finger_change",
    "plan_exchange": "regrasp.planning.changes.finger_change",
    "plan_motions": "regrasp.motions.plan",
    "plan_regrasp": "regrasp.motions.regrasps",
    "plan_regrasps": "regrasp.planning.regrasps.verbs",
    "plan_removal": "regrasp.planning.changes.finger_change",
    "plan_rotation": "regrasp.planning.changes.rotation",
    "pyramid_losses": "regrasp.planning.surveys.pyramid_loss",
    "PyramidLosses": "regrasp.planning.surveys.pyramid_loss",
    "Quality": "regrasp.measures.measure",
    "quality": "regrasp.measures.quality",
    "read_study": "regrasp.studies.study",
    "regrasps_on_outline": "regrasp.planning.anywhere.deciding",
    "RegraspCut": "regrasp.plans.regrasp_cut",
    "RegraspObstacle": "regrasp.planning.regrasps.why_not",
    "RegraspPlan": "regrasp.plans.regrasp_plan",
    "RegraspProblem": "regrasp.planning.regrasps.problem",
    "RegraspWeights": "regrasp.planning.holds.weights",
    "SampledPath": "regrasp.plans.sampled",
    "Sensitivity": "regrasp.planning.surveys.sensitivity",
    "sensitivity": "regrasp.planning.surveys.sensitivity",
    "SqueezeLocus": "regrasp.planning.surveys.squeeze_locus",
    "StraightPath": "regrasp.plans.straight",
    "surface_map": "regrasp.planning.placement.space.surface_map",
    "SurfaceMap": "regrasp.planning.placement.space.surface_map",
    "sweep": "regrasp.studies.sweeping",
    "TimeScaling": "regrasp.plans.timing",
    "Transition": "regrasp.plans.transition",
    "Tolerances": "regrasp.planning.robustness.tolerances",
    "tolerances": "regrasp.planning.robustness.tolerances",
    "TurningPath": "regrasp.plans.turning",
    "Verification": "regrasp.verification",
    "verify": "regrasp.verification",
    "wrench_ball": "regrasp.measures.wrench_ball",
    "WrenchBall": "regrasp.measures.wrench_ball",
}

__all__ = [
    "BatchStates",
    "BatchTolerances",
    "Bottleneck",
    "ChosenGrasp",
    "ChosenState",
    "Closure",
    "Contact",
    "ContactRegions",
    "Criteria",
    "EquilibriumLocus",
    "EscapeTwist",
    "FaceRegions",
    "ForceCost",
    "ForceLimits",
    "Grasp",
    "GraspState",
    "HeldCentres",
    "HeldDirections",
    "HeldSphere",
    "HoldGraph",
    "Infeasible",
    "InvalidInput",
    "LargestLoad",
    "LeastFriction",
    "LoadSeries",
    "LoadSet",
    "MarginCurve",
    "Margins",
    "Measure",
    "Mesh",
    "Outline",
    "OutlineCut",
    "OutlineRegrasps",
    "PlacementMap",
    "PyramidLosses",
    "Quality",
    "RegraspError",
    "RegraspCut",
    "RegraspObstacle",
    "RegraspPlan",
    "RegraspProblem",
    "RegraspWeights",
    "SampledPath",
    "Sensitivity",
    "SolverFailed",
    "SolverUnavailable",
    "SqueezeLocus",
    "StraightPath",
    "SurfaceMap",
    "TimeScaling",
    "Tolerances",
    "Transition",
    "TurningPath",
    "Verification",
    "Wrench",
    "WrenchBall",
    "batch_tolerances",
    "best_squeezes",
    "bottleneck",
    "choose_grasp",
    "carried_load",
    "choose_state",
    "choose_states",
    "closure",
    "contact_regions",
    "held_centres",
    "held_directions",
    "held_sphere",
    "largest_load",
    "least_friction",
    "least_stiffness",
    "locus_intervals",
    "margin_curve",
    "placement_map",
    "plan_addition",
    "plan_exchange",
    "plan_hold",
    "plan_motions",
    "plan_regrasp",
    "plan_regrasps",
    "plan_removal",
    "plan_rotation",
    "pyramid_losses",
    "quality",
    "read_study",
    "regrasps_on_outline",
    "sensitivity",
    "surface_map",
    "sweep",
    "tolerances",
    "torque_limits",
    "verify",
    "wrench_ball",
    "wrench_balls",
]


# Rooms with names of their own: `rg.files.write_plan` and the like work without a second import.
_ROOMS = (
    "bench",
    "closed_form",
    "errors",
    "execution",
    "explore",
    "files",
    "mechanics",
    "mesh",
    "motions",
    "outline",
    "planning",
    "plans",
    "plots",
    "programs",
)


def __getattr__(name: str) -> object:
    from importlib import import_module

    if name in _LATER:
        value: object = getattr(import_module(_LATER[name]), name)
        globals()[name] = value
        return value
    if name in _ROOMS:
        return import_module(f"regrasp.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
