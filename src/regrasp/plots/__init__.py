"""Pictures of grasps and transitions in the plane and in space. The only package that imports matplotlib.

Every function takes a value and, if wanted, the axes to draw on, and returns the axes; it asks the value for
what it draws. New axes belong to a figure of their own (``ax.figure``), as wide as a column. Labels say
N, m and s unless ``units`` names others; numbers are never converted.
"""

from inspect import isfunction
from typing import TYPE_CHECKING

from regrasp.later import later

if TYPE_CHECKING:
    from regrasp.plots.escapes.escape import plot_escape
    from regrasp.plots.grasps.outline import plot_outline
    from regrasp.plots.grasps.state import plot_state, plot_transition
    from regrasp.plots.look.png import png
    from regrasp.plots.look.style import contact_colours
    from regrasp.plots.look.units import SI, Units
    from regrasp.plots.over_time.components import plot_force_components, plot_wrench_components
    from regrasp.plots.over_time.execution import (
        execution_figure,
        plot_friction_use,
        plot_measured_forces,
        plot_slip,
    )
    from regrasp.plots.over_time.load import plot_load
    from regrasp.plots.over_time.magnitudes import plot_angles, plot_magnitudes, plot_margins
    from regrasp.plots.over_time.rates import plot_rates
    from regrasp.plots.over_time.scaling import plot_scaling
    from regrasp.plots.pages.film import animate
    from regrasp.plots.pages.overview import (
        figures,
        iso_torque_figure,
        states_figure,
        transition_figure,
        transition_png,
        wrenches_figure,
    )
    from regrasp.plots.pages.page import html
    from regrasp.plots.pages.run_film import animate_execution
    from regrasp.plots.placement.chosen import plot_chosen_grasp, plot_contact_regions
    from regrasp.plots.placement.maps import plot_placement_map, plot_placement_outline
    from regrasp.plots.placement.surface_maps import plot_surface_map
    from regrasp.plots.regrasps.hold_arcs import plot_hold_arcs, plot_hold_margins
    from regrasp.plots.regrasps.hold_map import plot_hold_map
    from regrasp.plots.regrasps.outline_map import plot_outline_map
    from regrasp.plots.regrasps.steps import plot_regrasp
    from regrasp.plots.regrasps.trade_off import plot_trade_off
    from regrasp.plots.regrasps.ways import plot_motions
    from regrasp.plots.surveys.held_directions import plot_directions
    from regrasp.plots.surveys.held_sphere import load_sphere_figure, plot_load_map, plot_load_sphere
    from regrasp.plots.surveys.margin_curve import plot_margin_curve
    from regrasp.plots.surveys.sensitivity import plot_sensitivity
    from regrasp.plots.surveys.tolerances import plot_tolerances
    from regrasp.plots.wrench_space.iso_torque import plot_iso_torque
    from regrasp.plots.wrench_space.load_set import plot_load_set
    from regrasp.plots.wrench_space.locus import plot_locus
    from regrasp.plots.wrench_space.planes_and_cones import (
        plot_locus_segment,
        plot_wrench_cone,
        plot_wrench_plane,
    )
    from regrasp.plots.wrench_space.wrench_loop import plot_wrench_loop, plot_wrench_paths

__all__ = [
    "SI",
    "Units",
    "animate",
    "animate_execution",
    "contact_colours",
    "execution_figure",
    "figures",
    "html",
    "iso_torque_figure",
    "load_sphere_figure",
    "plot_angles",
    "plot_chosen_grasp",
    "plot_contact_regions",
    "plot_directions",
    "plot_escape",
    "plot_force_components",
    "plot_friction_use",
    "plot_hold_arcs",
    "plot_hold_map",
    "plot_hold_margins",
    "plot_iso_torque",
    "plot_load",
    "plot_load_map",
    "plot_load_set",
    "plot_load_sphere",
    "plot_locus",
    "plot_locus_segment",
    "plot_magnitudes",
    "plot_margin_curve",
    "plot_margins",
    "plot_measured_forces",
    "plot_motions",
    "plot_outline",
    "plot_outline_map",
    "plot_placement_map",
    "plot_placement_outline",
    "plot_rates",
    "plot_regrasp",
    "plot_scaling",
    "plot_sensitivity",
    "plot_slip",
    "plot_state",
    "plot_surface_map",
    "plot_tolerances",
    "plot_trade_off",
    "plot_transition",
    "plot_wrench_components",
    "plot_wrench_cone",
    "plot_wrench_loop",
    "plot_wrench_paths",
    "plot_wrench_plane",
    "png",
    "states_figure",
    "transition_figure",
    "transition_png",
    "wrenches_figure",
]

_WHERE = {
    "SI": "look.units",
    "Units": "look.units",
    "animate": "pages.film",
    "animate_execution": "pages.run_film",
    "contact_colours": "look.style",
    "execution_figure": "over_time.execution",
    "figures": "pages.overview",
    "html": "pages.page",
    "iso_torque_figure": "pages.overview",
    "load_sphere_figure": "surveys.held_sphere",
    "plot_angles": "over_time.magnitudes",
    "plot_chosen_grasp": "placement.chosen",
    "plot_contact_regions": "placement.chosen",
    "plot_directions": "surveys.held_directions",
    "plot_escape": "escapes.escape",
    "plot_force_components": "over_time.components",
    "plot_friction_use": "over_time.execution",
    "plot_hold_arcs": "regrasps.hold_arcs",
    "plot_hold_map": "regrasps.hold_map",
    "plot_hold_margins": "regrasps.hold_arcs",
    "plot_iso_torque": "wrench_space.iso_torque",
    "plot_load": "over_time.load",
    "plot_load_map": "surveys.held_sphere",
    "plot_load_set": "wrench_space.load_set",
    "plot_load_sphere": "surveys.held_sphere",
    "plot_locus": "wrench_space.locus",
    "plot_locus_segment": "wrench_space.planes_and_cones",
    "plot_magnitudes": "over_time.magnitudes",
    "plot_margin_curve": "surveys.margin_curve",
    "plot_margins": "over_time.magnitudes",
    "plot_measured_forces": "over_time.execution",
    "plot_motions": "regrasps.ways",
    "plot_outline": "grasps.outline",
    "plot_outline_map": "regrasps.outline_map",
    "plot_placement_map": "placement.maps",
    "plot_placement_outline": "placement.maps",
    "plot_rates": "over_time.rates",
    "plot_regrasp": "regrasps.steps",
    "plot_scaling": "over_time.scaling",
    "plot_sensitivity": "surveys.sensitivity",
    "plot_slip": "over_time.execution",
    "plot_state": "grasps.state",
    "plot_surface_map": "placement.surface_maps",
    "plot_tolerances": "surveys.tolerances",
    "plot_trade_off": "regrasps.trade_off",
    "plot_transition": "grasps.state",
    "plot_wrench_components": "over_time.components",
    "plot_wrench_cone": "wrench_space.planes_and_cones",
    "plot_wrench_loop": "wrench_space.wrench_loop",
    "plot_wrench_paths": "wrench_space.wrench_loop",
    "plot_wrench_plane": "wrench_space.planes_and_cones",
    "png": "look.png",
    "states_figure": "pages.overview",
    "transition_figure": "pages.overview",
    "transition_png": "pages.overview",
    "wrenches_figure": "pages.overview",
}


def _checked(value: object) -> object:
    from regrasp.plots.look.given import checked

    return checked(value) if isfunction(value) else value


__getattr__, __dir__ = later(__name__, _WHERE, _checked)
