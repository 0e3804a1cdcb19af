"""Ways through the air: how fingers without force go from contact to contact, clear of everything."""

from regrasp.motions.plan import plan_motions
from regrasp.motions.regrasps import plan_regrasp_motions
from regrasp.motions.shut_in import ShutIn
from regrasp.motions.value import Motion, Motions

__all__ = ["Motion", "Motions", "ShutIn", "plan_motions", "plan_regrasp_motions"]
