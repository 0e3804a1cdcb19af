"""A question as Python and as a scenario, to go on with elsewhere."""

import json

from regrasp.explore.question import Question, Shape

_MAYBE = ("max_force", "torsion")


def as_python(question: Question, shape: Shape | None = None) -> str:
    """A program that plans and verifies what the page shows.

    Args:
        question: what is asked.
        shape: contacts stand on its nearest points.
    """
    asked = question.on(shape)
    lines = ["import regrasp as rg", "", "grasp = rg.Grasp(", "    ["]
    for c in asked.contacts:
        limit = "".join(f", {key}={c[key]!r}" for key in _MAYBE if key in c)
        given = f"{c['position']!r}, normal={c['normal']!r}, friction={c['friction']!r}{limit}"
        lines.append(f"        rg.Contact({given}, name={c['name']!r}),")
    force, torque = _load(asked)
    lines += ["    ]", ")", f"load = rg.Wrench({force}, torque={torque})"]
    if asked.leaves is None:
        lines += [f"state = rg.choose_state(grasp, load, {asked.objective!r})", "print(state)"]
        return "\n".join(lines) + "\n"
    end = ""
    if asked.squeeze is not None and len(asked.contacts) == 3 and asked.dimension == 2:
        lines += [
            f"locus = rg.EquilibriumLocus(grasp.without({asked.leaves!r}), load)",
            f"end = locus.state({asked.squeeze!r})",
        ]
        end = ", end=end"
    lines += [
        f"plan = rg.plan_removal(grasp, {asked.leaves!r}, load=load, objective={asked.objective!r}{end}, "
        f"duration={asked.duration!r})",
        "print(plan)",
        "print(rg.verify(plan))",
    ]
    return "\n".join(lines) + "\n"


def as_scenario(question: Question, shape: Shape | None = None) -> str:
    """A scenario for ``regrasp plan``; where nobody leaves, the last finger does.

    Args:
        question: what is asked.
        shape: contacts stand on its nearest points.
    """
    asked = question.on(shape)
    force, torque = _load(asked)
    lines = ['title = "From the explorer"', "", "[load]", f"force = {force}", f"torque = {torque}"]
    for c in asked.contacts:
        lines += ["", "[[contacts]]", f"name = {_quoted(c['name'])}"]
        lines += [f"{key} = {c[key]!r}" for key in ("position", "normal", "friction")]
        lines += [f"{key} = {c[key]!r}" for key in _MAYBE if key in c]
    leaves = asked.contacts[-1]["name"] if asked.leaves is None else asked.leaves
    lines += ["", "[task]", 'kind = "removal"', f"contact = {_quoted(leaves)}"]
    lines += [f'objective = "{asked.objective}"', f"duration = {asked.duration!r}"]
    return "\n".join(lines) + "\n"


def _load(asked: Question) -> tuple[str, str]:
    """Force and torque as text, which Python and TOML write alike."""
    force, torque = list(asked.load[: asked.dimension]), list(asked.load[asked.dimension :])
    return repr(force), repr(torque if asked.dimension == 3 else torque[0])


def _quoted(text: str) -> str:
    """A basic string of TOML, which JSON's are, all but what is beyond 16 bits written as itself."""
    return json.dumps(text, ensure_ascii=False)
