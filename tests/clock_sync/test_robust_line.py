"""The robust line through clock differences."""

import numpy as np

from pdr_est.clock_sync.robust_line import fit_clock_line


def test_the_line_ignores_what_is_not_on_it() -> None:
    time_s = np.arange(20.0) * 60.0
    difference = 0.5 + 5e-5 * time_s
    difference[[3, 11]] += 0.5
    line = fit_clock_line(time_s, difference, 1e-4, 0.001)
    np.testing.assert_allclose(line.difference_at(time_s), 0.5 + 5e-5 * time_s, atol=1e-4)
    assert list(np.flatnonzero(~line.inlier)) == [3, 11]
