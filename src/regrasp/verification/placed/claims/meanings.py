"""What objectives mean to those who check them, written again."""

# objective: size of a force, norm of the sizes
MEANINGS = {
    "sum_normal": ("normal", "sum"),
    "peak_normal": ("normal", "largest"),
    "peak": ("force", "largest"),
    "effort": ("force", "squares"),
    # levels at which forces below the limit must exist
    "friction_use": ("force", "largest"),
    "angle": ("force", "largest"),
    "force": ("margin", "largest"),
    "answered": ("force", "largest"),
    "wrench": ("force", "largest"),
    "wrench_ball": ("normal", "largest"),
}
LEVELS = ("friction_use", "angle", "force", "answered", "wrench", "wrench_ball")
SPACE_LEVELS = ("friction_use", "angle", "answered")  # those that meshes have bounds for
LARGEST = ("angle", "force", "answered", "wrench", "wrench_ball")  # what is best as large as can be
ANY_LOAD = ("answered", "wrench", "wrench_ball")  # their proofs have loads that no state holds
CLOSE = 1e-9  # of a value, the same in another order of the sums


def power_of(norm: str) -> int:
    """Values of squares are their sum, not its root."""
    return 2 if norm == "squares" else 1
