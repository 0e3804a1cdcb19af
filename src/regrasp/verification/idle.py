"""Which fingers a transition says carry no force at its ends, and whether they do not."""

from regrasp.errors import shown
from regrasp.mechanics.value import one_line
from regrasp.verification.protocols import Plan


def check_idle(plan: Plan) -> list[str]:
    """What is wrong with the fingers that a transition names."""
    broken = []
    for verb, names in (("leaves", plan.leaving), ("arrives", plan.arriving)):
        if not isinstance(names, tuple) or len(set(names)) != len(names):
            return [
                f"the fingers of which each {verb} must be a tuple of different names, got {shown(names)}"
            ]
    broken += [f"contact {shown(name)} leaves and arrives" for name in plan.leaving if name in plan.arriving]
    ends = (("start", plan.start, plan.arriving), ("end", plan.end, plan.leaving))
    for label, state, idle in ends:
        for name in idle:
            if name not in state.grasp.names:
                known = ", ".join(map(one_line, state.grasp.names))
                broken.append(f"contact {shown(name)} is not one of {known}")
                continue
            force = state.forces[state.grasp.names.index(name)].tolist()
            if any(force):
                broken.append(f"{label}: {one_line(name)} must carry no force, it carries {force}")
    return broken
