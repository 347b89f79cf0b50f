"""No simulated walker is turned by a change of placement while the track claims to know better."""

import pytest
from turned_walkers import Corners, heading_errors, summary, walker

from pdr_est.simulate import simulate_walk


@pytest.mark.slow
@pytest.mark.parametrize(("corners", "walks"), [("mixed", 24), ("right", 8), ("free", 8)])
def test_no_walk_is_turned_unawares(corners: Corners, walks: int) -> None:
    row = summary([heading_errors(simulate_walk(walker(seed, corners))) for seed in range(60000, 60000 + walks)])
    assert row["turned_unawares"] == 0
    assert row["turned"] <= 0.3 * walks
    assert row["heading_median_deg"] < 5.0
    assert row["error_over_sigma"] < 1.3


def test_priors_do_not_decide_between_a_corner_and_half_of_it() -> None:
    """A corner of 45 degrees beside a change: priors on both sides of it made the wrong turn sure."""
    errors = heading_errors(simulate_walk(walker(60105, "mixed")))
    assert not errors.unawares
