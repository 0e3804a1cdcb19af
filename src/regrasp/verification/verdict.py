"""The verdict on a plan."""

from dataclasses import dataclass
from math import degrees, isfinite

from regrasp.display import table
from regrasp.mechanics.value import ArrayValue
from regrasp.verification.exact import RESOLUTION

_NOT_COVERED = "not covered: {}, fingers that slide or roll, loads with a torque about the centre of mass"


@dataclass(frozen=True, eq=False)
class Verification(ArrayValue):
    """The verdict on a plan.

    Args:
        violations: each broken condition in words; none for a valid plan.
        worst_residual: largest equilibrium residual checked, relative to the forces [-]. A plan is not
            verified above 2^-40, nor where the residual is more than 2^-10 of its largest load.
        least_angle: smallest angle margin of the contacts in use [rad], for information; infinite where none
            is.
        least_cone_slack: smallest (1 + mu^2) - |f|^2 / (f.n)^2 over forces, exact before rounding; >= 0
            inside.
        load_gap: largest difference of the plan's load from the load function given [N], torque divided by
            the grasp's size; None where none was given.
        load_gap_is_proven: from a bound on the load's curvature, and not measured between the instants.
        excluded: boxes of places that a proof excludes, of a chosen grasp or an ``OutlineCut``; None of
            others.
        bound: no placement has a smaller value than this, of a chosen grasp; None of others.
        crossing: pairs of contacts that cross a cut, of which none holds; None of others.
        components: which pairs of a cut's contacts may hold, and the components that they form, in
            words; empty for others.
        asked: what every hold of the regrasps that a cut excludes had to keep, of an ``OutlineCut`` at which
            orientations, too; or which part of its outline a proof about places is of, in words; empty for
            nothing.
        widest: no arcs around the places of contact regions are all longer [m]; None of others.
        withstood: what every instant withstands besides the load, asked for or on the plan's record, in
            words; empty for nothing.
    """

    violations: tuple[str, ...]
    worst_residual: float
    least_angle: float
    least_cone_slack: float
    load_gap: float | None = None
    load_gap_is_proven: bool = False
    excluded: int | None = None
    bound: float | None = None
    crossing: int | None = None
    components: str = ""
    asked: str = ""
    withstood: str = ""
    widest: float | None = None

    @property
    def ok(self) -> bool:
        """Whether the plan holds the object at every instant, inside every cone and limit."""
        return not self.violations

    def _repr_html_(self) -> str:
        """The verdict and what it rests on, for notebooks."""
        verdict, *more = str(self).splitlines()
        rows: list[list[object]] = [["verdict", verdict]]
        rows += [["", line.strip()] for line in more]
        if self.ok and isfinite(self.least_angle):
            rows.append(["least angle margin [deg]", degrees(self.least_angle)])
        if isfinite(self.worst_residual):
            rows.append(["worst residual, of the forces [-]", self.worst_residual])
        return table(["", "verified" if self.ok else "NOT verified"], rows)

    def __str__(self) -> str:
        if not self.ok:
            return "\n".join(["not verified:", *(f"  {violation}" for violation in self.violations)])
        if self.crossing is not None:
            return (
                f"no regrasp leads from the start to the goal on these contacts{self.asked}, at any "
                f"orientation: none of {self.crossing} pairs across the cut holds a load{self.asked}, "
                f"in exact arithmetic\n{self.components}{chr(10) if self.components else ''}"
                f"{_NOT_COVERED.format('contacts elsewhere')}"
            )
        by = f", by {self.least_angle:.6g} rad or more" if isfinite(self.least_angle) else ""
        lines = [
            f"verified in exact arithmetic: in equilibrium within {float(RESOLUTION):.1g} of the forces, "
            f"every force inside its cone{by}"
        ]
        if self.widest is not None:
            lines.append(f"no arcs around these places are all longer than {self.widest:.6g}")
        if self.withstood:
            lines.append(f"every instant withstands {self.withstood}")
        if self.load_gap is not None:
            how = "proven" if self.load_gap_is_proven else "measured between instants, not proven"
            lines.append(
                f"the plan's load is within {self.load_gap:.3g} of the load given ({how}), "
                f"which the margins can take"
            )
        if self.excluded is not None and self.bound is None:
            return (
                f"no regrasp leads from the start to the goal on this outline, at {self.asked}: "
                f"{self.excluded} boxes cover all pairs of places across the cut, each excluded by its "
                f"twist, in exact arithmetic\n{_NOT_COVERED.format('other orientations, fingers on holes')}"
            )
        if self.excluded is not None:
            if not isfinite(self.least_cone_slack):  # the proof alone
                lines = []
            lines.append(
                f"no placement{self.asked} is better than {self.bound:.6g}: "
                + (
                    "one box covers all of them, excluded by its twist"
                    if self.excluded == 1
                    else f"{self.excluded} boxes cover all of them, each excluded by its twist"
                )
            )
        return "\n".join(lines)
