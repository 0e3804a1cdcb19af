"""Independent check of plans in exact rational arithmetic.

Shares no code with the planner: it imports mechanics only, and of these only the values.
"""

from regrasp.verification.exact import HELD, RESOLUTION
from regrasp.verification.plans import verify
from regrasp.verification.sampling import verify_setpoints
from regrasp.verification.verdict import Verification
from regrasp.verification.ways.rows import MotionRowsVerification, verify_motion_rows
from regrasp.verification.ways.verdict import MotionsVerification, verify_motions

__all__ = [
    "HELD",
    "RESOLUTION",
    "MotionRowsVerification",
    "MotionsVerification",
    "Verification",
    "verify",
    "verify_motion_rows",
    "verify_motions",
    "verify_setpoints",
]
