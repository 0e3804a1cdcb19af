"""Ways through the air: how fingers without force go from contact to contact, clear of everything."""

from regrasp.motions.plan import plan_motions
from regrasp.motions.value import Motion, Motions

__all__ = ["Motion", "Motions", "plan_motions"]
