"""Where things lie, for tests in any room."""

from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
ROOT = TESTS.parent
EXAMPLES = ROOT / "examples"
SCENARIOS = sorted(path for path in EXAMPLES.glob("*.toml") if path.stem != "study")
"""Each plans something by itself."""
