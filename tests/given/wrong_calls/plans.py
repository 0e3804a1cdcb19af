"""What plans are made of, and whole ones."""

import regrasp as rg
from paper import LOAD
from values import bent, regrasp, removal, rotation
from wrong_calls.row import Row


def rows() -> dict[str, Row]:
    scaling, series = rg.TimeScaling.spline(1.0), rg.LoadSeries([0, 1], [[0, 0, 0], [1, 1, 1]])
    transition, turn, whole = removal(), rotation(), regrasp()
    return {
        "LoadSeries": Row(
            rg.LoadSeries,
            {"times": [0, 1], "vectors": [[0, 0, 0], [1, 1, 1]]},
            {"times": "rising", "vectors": "table"},
        ),
        "LoadSeries.sampled": Row(
            rg.LoadSeries.sampled,
            {"load": lambda t: LOAD, "duration": 1.0},
            {"load": "function", "instants": "count"},
        ),
        "LoadSeries.__call__": Row(series.__call__, {"t": 0.5}, {"t": "number"}),
        "LoadSeries.at": Row(series.at, {"t": 0.5}),
        "LoadSeries.refined": Row(series.refined, {"instants": 5}, free=("also",)),
        "LoadSeries.from_dict": Row(rg.LoadSeries.from_dict, {"data": series.to_dict()}),
        "TimeScaling": Row(
            rg.TimeScaling, {"duration": 1.0, "control": (1, 0), "degree": 1}, {"control": "control"}
        ),
        "TimeScaling.spline": Row(rg.TimeScaling.spline, {"duration": 1.0}, {"control": "control"}),
        "TimeScaling.minimum_jerk": Row(rg.TimeScaling.minimum_jerk, {"duration": 1.0}),
        "TimeScaling.linear": Row(rg.TimeScaling.linear, {"duration": 1.0}),
        "TimeScaling.fastest": Row(
            rg.TimeScaling.fastest,
            {"change": [[1.0, 0.0], [1.0, 1.0]], "rate_limit": 1.0},
            {"change": "table", "shape": "value", "rate_limit": "limits of two"},
        ),
        "TimeScaling.lasting": Row(scaling.lasting, {"duration": 2.0}),
        "TimeScaling.__call__": Row(scaling.__call__, {"t": 0.5}),
        "TimeScaling.velocity": Row(scaling.velocity, {"t": 0.5}),
        "TimeScaling.acceleration": Row(scaling.acceleration, {"t": 0.5}),
        "TimeScaling.from_dict": Row(rg.TimeScaling.from_dict, {"data": scaling.to_dict()}),
        "carried_load": Row(
            rg.carried_load,
            {"mass": 1.0, "gravity": [0.0, -9.81]},
            {
                "mass": "positive",
                "gravity": "vector",
                "position": "function",
                "orientation": "function",
                "inertia": "number",
                "step": "positive",
            },
        ),
        "verify": Row(
            rg.verify,
            {"plan": transition},
            {
                "load": "function",
                "curvature": "not negative",
                "position": "squeezes",
                "surface": "curvatures",
            },
        ),
        "Transition.forces": Row(transition.forces, {"t": 0.5}),
        "Transition.wrenches": Row(transition.wrenches, {"t": 0.5}),
        "Transition.rates": Row(transition.rates, {"t": 0.5}),
        "Transition.load": Row(transition.load, {"t": 0.5}),
        "Transition.orientation": Row(transition.orientation, {"t": 0.5}),
        "Transition.margins": Row(transition.margins, {"t": 0.5}),
        "Transition.times": Row(transition.times, {"rate": 10.0}),
        "Transition.retimed": Row(transition.retimed, {"scaling": scaling}),
        "Transition.fastest": Row(transition.fastest, {"rate_limit": 10.0}),
        "Transition.to_dataframe": Row(transition.to_dataframe, {"rate": 10.0}),
        "Transition.from_dict": Row(rg.Transition.from_dict, {"data": transition.to_dict()}),
        "bent Transition.forces": Row(bent().forces, {"t": 0.1}),
        "bent Transition.rates": Row(bent().rates, {"t": 0.1}),
        "turning Transition.forces": Row(turn.forces, {"t": 0.5}),
        "turning Transition.rates": Row(turn.rates, {"t": 0.5}),
        "turning Transition.fastest": Row(
            turn.fastest, {"rate_limit": 10.0}, {"rate_limit": "limits of two"}
        ),
        "RegraspPlan.orientation": Row(whole.orientation, {"t": 0.5}),
        "RegraspPlan.from_dict": Row(rg.RegraspPlan.from_dict, {"data": whole.to_dict()}),
    }
