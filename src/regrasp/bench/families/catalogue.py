"""All families by name."""

from regrasp.bench.families.hard import DEGENERATE, INFEASIBLE, NEARLY, SCALED
from regrasp.bench.families.loci import LOCI
from regrasp.bench.families.paths import PATHS
from regrasp.bench.families.regrasps import REGRASPS
from regrasp.bench.families.space import SPACE_CONES, SPACE_PYRAMIDS
from regrasp.bench.families.states import STATES
from regrasp.bench.families.warm import WARM
from regrasp.bench.problems.problem import Family

_ALL = (
    STATES,
    LOCI,
    PATHS,
    REGRASPS,
    SPACE_CONES,
    SPACE_PYRAMIDS,
    NEARLY,
    INFEASIBLE,
    DEGENERATE,
    SCALED,
    WARM,
)
FAMILIES: dict[str, Family] = {family.name: family for family in _ALL}
