"""Which fingers a transition says carry no force at its ends, and whether they do not."""

from regrasp.mechanics.value import one_line
from regrasp.verification.protocols import Plan

KINDS = ("removal", "addition", "rotation", "exchange")


def idle_fingers(plan: Plan) -> tuple[tuple[str | None, ...], tuple[str | None, ...]]:
    """Names of the fingers without force at the start, and of those at the end."""
    if plan.kind == "exchange":
        return (plan.arrival,), (plan.contact,)
    named = () if plan.contact is None else (plan.contact,)
    return ((), named) if plan.kind == "removal" else (named, ())


def check_idle(plan: Plan) -> list[str]:
    """What is wrong with the fingers that a transition names."""
    if plan.kind not in KINDS:
        return [f"kind {plan.kind!r} is none of {', '.join(KINDS)}"]
    named = plan.contact is not None, plan.arrival is not None
    wanted = plan.kind != "rotation", plan.kind == "exchange"
    if named != wanted or (plan.kind == "exchange" and plan.contact == plan.arrival):
        return [f"{plan.kind} names the wrong fingers: {plan.contact!r} and {plan.arrival!r}"]
    broken = []
    for label, state, idle in zip(("start", "end"), (plan.start, plan.end), idle_fingers(plan), strict=True):
        for name in idle:
            if name not in state.grasp.names:
                known = ", ".join(map(one_line, state.grasp.names))
                broken.append(f"contact {name!r} is not one of {known}")
                continue
            force = state.forces[state.grasp.names.index(name)].tolist()
            if any(force):
                broken.append(f"{label}: {one_line(name)} must carry no force, it carries {force}")
    return broken
