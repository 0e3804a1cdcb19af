"""Which turns are asked for."""

import pytest

import regrasp as rg
from paper import STATE

pytestmark = pytest.mark.contract


@pytest.mark.parametrize("degrees", [6e4, -6e4, 1e30, 1e308])
def test_turns_that_would_never_end_are_refused(degrees: float) -> None:
    with pytest.raises(rg.InvalidInput, match="at most 1000 rad"):
        rg.plan_rotation(STATE, degrees=degrees)
