"""The rules of Robust DR on made-up signals whose steps follow from them by hand."""

from dataclasses import replace

import numpy as np
import pytest
from signals import level, run

from pdr_est.front_end.steps.relative_threshold import RelativeThreshold, RelativeThresholdParams

RATE_HZ = 100.0
UNFILTERED = {"pre_window_s": 0.01, "post_window_s": 0.01, "threshold_mps2": 1.0}


def step_times(*corners: tuple[float, float], **changes: float) -> list[float]:
    """Steps of a signal of straight lines through (time, value) corners, zero at the beginning."""
    time_s, values = zip((0.0, 0.0), *corners, strict=True)
    signal = np.interp(np.arange(round(time_s[-1] * RATE_HZ) + 1) / RATE_HZ, time_s, values)
    detector = RelativeThreshold(RATE_HZ, RelativeThresholdParams(**{**UNFILTERED, **changes}))
    return [event.time_s for event in run(detector, [level(signal, rate_hz=RATE_HZ)])]


def test_a_step_is_a_maximum_and_the_minimum_after_it() -> None:
    found = step_times((0.3, 2.0), (0.6, -1.0), (0.9, 2.0), (1.2, -1.0), (1.5, 2.0))
    assert found == pytest.approx([0.6, 1.2])


@pytest.mark.parametrize(("height", "found"), [(0.9, [0.6, 1.8]), (1.1, [0.6, 1.2, 1.8])])
def test_a_maximum_must_exceed_the_minimum_before_it_by_the_threshold(height: float, found: list[float]) -> None:
    corners = [(0.3, 2.0), (0.6, 0.0), (0.9, height), (1.2, -1.0), (1.5, 2.0), (1.8, 0.0), (2.0, 0.5)]
    assert step_times(*corners) == pytest.approx(found)


@pytest.mark.parametrize(("trough", "found"), [(1.1, []), (0.9, [0.6])])
def test_a_minimum_must_lie_below_the_maximum_before_it_by_the_threshold(trough: float, found: list[float]) -> None:
    assert step_times((0.3, 2.0), (0.6, trough), (0.9, 1.5)) == pytest.approx(found)


@pytest.mark.parametrize("later_s", np.arange(0.0, 0.2, 0.01).tolist())
@pytest.mark.parametrize(("gap_s", "found"), [(0.14, [0.6, 1.4]), (0.15, [0.6, 0.6 + 2 * 0.15, 1.4])])
def test_extremes_must_be_150_ms_apart(gap_s: float, found: list[float], later_s: float) -> None:
    """The maximum after 0.6 s comes after the gap, the minimum after it after another one; times are rounded."""
    corners = [(0.3, 2.0), (0.6, 0.0), (0.6 + gap_s, 2.0), (0.6 + 2 * gap_s, 0.0), (1.1, 2.0), (1.4, 0.0), (1.5, 1.0)]
    shifted = [(time_s + later_s, value) for time_s, value in corners]
    assert step_times((later_s, 0.0), *shifted) == pytest.approx([time_s + later_s for time_s in found])


def test_the_time_between_maximum_and_minimum_counts_too() -> None:
    corners = [(0.3, 2.0), (0.4, 0.0), (0.6, 0.5), (0.8, -0.5), (0.9, 0.0)]
    assert step_times(*corners) == pytest.approx([0.8])


def test_a_later_valid_maximum_takes_the_place_of_a_higher_one() -> None:
    """2.6 at 0.7 s exceeds the beginning by the threshold; from there 1.8 is not low enough, 1.5 is."""
    corners = [(0.3, 3.0), (0.5, 2.5), (0.7, 2.6)]
    assert step_times(*corners, (1.0, 1.8), (1.1, 2.0)) == []
    assert step_times(*corners, (1.0, 1.5), (1.1, 2.0)) == pytest.approx([1.0])


def test_a_second_minimum_is_no_second_step_but_the_new_reference() -> None:
    corners = [(0.3, 2.0), (0.6, 0.5), (0.8, 1.0), (1.0, -1.0), (1.3, 0.2), (1.6, -1.5), (1.7, 0.0)]
    # 1.0 is not 1 above 0.5: no maximum. -1 at 1.0 s is valid and from there 0.2 is high enough.
    assert step_times(*corners) == pytest.approx([0.6, 1.6])


def test_the_reference_is_the_most_recent_minimum_and_not_the_lowest() -> None:
    """After the minimum of 0 at 1.2 s, 0.5 is no valid maximum, although it is far above -5 at 0.6 s."""
    corners = [(0.3, 2.0), (0.6, -5.0), (0.9, 2.0), (1.2, 0.0), (1.5, 0.5), (1.8, -0.6), (2.0, 0.0)]
    assert step_times(*corners) == pytest.approx([0.6, 1.2])


def test_a_walk_may_begin_downwards() -> None:
    assert step_times((0.3, -2.0), (0.6, 1.0), (0.9, -2.0), (1.0, 0.0)) == pytest.approx([0.9])


@pytest.mark.parametrize("rate_hz", [25.0, 50.0, 100.0, 400.0])
@pytest.mark.parametrize("tilt_rad", [0.0, 0.9, 2.5])
def test_both_averages_are_taken_off_the_time_and_the_tilt_does_not_matter(rate_hz: float, tilt_rad: float) -> None:
    time_s = np.arange(round(10.0 * rate_hz)) / rate_hz
    flat = level(2.0 * np.sin(2.0 * np.pi * 1.8 * time_s), rate_hz=rate_hz)
    up = np.tile([0.0, np.sin(tilt_rad), np.cos(tilt_rad)], (len(flat), 1))
    tilted = replace(flat, up=up, acceleration_mps2=up * flat.vertical_mps2[:, None])
    found = [event.time_s for event in run(RelativeThreshold(rate_hz, RelativeThresholdParams()), [tilted])]
    troughs_s = (np.arange(18) + 0.75) / 1.8
    expected = troughs_s[(troughs_s > 0.5) & (troughs_s < 9.7)]
    np.testing.assert_allclose([t for t in found if 0.5 < t < 9.7], expected, atol=0.7 / rate_hz)


def test_the_averaged_reading_is_projected_with_the_latest_attitude() -> None:
    """A phone at rest is turned on its side at 0.5 s and at 1.2 s, for 0.1 s each.

    At once, 19 of 20 averaged readings still point along the old axis, and 0.05 g - g is left along the new one. The
    second of these troughs follows the rest at 0, which is the maximum. Projected before the average, nothing moves.
    """
    count = np.arange(200)
    on_side = ((count >= 50) & (count < 60)) | ((count >= 120) & (count < 130))
    up = np.where(on_side[:, None], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    turned = replace(level(np.zeros(200), rate_hz=RATE_HZ), up=up)
    detector = RelativeThreshold(RATE_HZ, RelativeThresholdParams(post_window_s=0.01, threshold_mps2=9.0))
    assert [event.time_s for event in run(detector, [turned])] == pytest.approx([1.2 - 0.095])


def test_extremes_of_an_earlier_segment_are_forgotten() -> None:
    """0.5 is a valid maximum after the trough of the first segment, but not after its own segment's first sample."""
    detector = RelativeThreshold(RATE_HZ, RelativeThresholdParams(**UNFILTERED))
    first = np.interp(np.arange(100), [0, 30, 60, 99], [0.0, 2.0, -5.0, -4.5])
    second = np.interp(np.arange(100), [0, 30, 60, 99], [0.0, 0.5, -1.0, -0.5])
    blocks = [level(first, rate_hz=RATE_HZ), level(second, segment=1, first_index=200, rate_hz=RATE_HZ)]
    assert [event.index for event in run(detector, blocks)] == [60]
