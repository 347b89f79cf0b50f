"""The number of steps by the spectrum, on signals whose rhythm is known."""

import numpy as np
import pytest

from pdr_est.evaluate.cadence_check import cadence_hz, count_plausibility
from pdr_est.front_end.signal.blocks import part
from pdr_est.types.sensors import LevelBlock

RATE_HZ = 50.0


def walk(cadence, duration_s=20.0, uneven=0.0, rest_s=0.0, segment=0, start_s=0.0):
    """Somebody who steps, each second step harder, and turns to and fro; at the end he stands for a while."""
    time_s = np.arange(0.0, duration_s, 1.0 / RATE_HZ)
    phase = 2.0 * np.pi * cadence * time_s
    walking = time_s < duration_s - rest_s
    vertical = walking * (3.0 * np.sin(phase) + uneven * np.sin(phase / 2.0) + np.sin(2.0 * phase))
    rate = walking[:, None] * np.stack([np.sin(phase / 2.0), 0.4 * np.sin(phase), 0.0 * phase], axis=1)
    none, vectors = np.zeros(len(time_s)), np.zeros((len(time_s), 3))
    modes = np.zeros(len(time_s), dtype=np.int8)
    return LevelBlock(0, segment, start_s + time_s, vectors, vectors, vertical, none, rate, none, modes, none)


@pytest.mark.parametrize("cadence", [1.2, 1.5, 2.0, 2.7, 3.5])
@pytest.mark.parametrize("uneven", [0.0, 4.0])
def test_the_cadence_is_found_however_uneven_the_feet_are(cadence, uneven):
    block = walk(cadence, 4.0, uneven)
    assert cadence_hz(block.vertical_mps2, block.rotation_rate_radps, RATE_HZ) == pytest.approx(cadence, abs=0.03)


@pytest.mark.parametrize("turning", [0.0, 1e-15])
def test_without_rotation_the_bounce_tells(turning):
    """Also when a subtracted bias left nothing but rounding in a gyroscope of zeros."""
    block = walk(1.8, 4.0)
    rate = turning * np.random.default_rng(0).standard_normal((len(block), 3))
    assert cadence_hz(block.vertical_mps2, rate, RATE_HZ) == pytest.approx(1.8, abs=0.03)


@pytest.mark.parametrize(("share", "ratio"), [(1, 1.0), (2, 0.5)])
def test_ratio_of_all_steps_and_of_every_second(share, ratio):
    steps_s = np.arange(0.1, 20.0, 0.5)[::share]
    found = count_plausibility([walk(2.0)], steps_s)
    assert found.expected == pytest.approx(40.0, rel=0.01)
    assert found.ratio == pytest.approx(ratio, rel=0.01)


def test_windows_of_rest_and_a_short_rest_are_left_out_with_their_steps():
    # Windows from 0 to 4 and 4 to 8 s are walked, 8 to 12 s is not, the last two seconds make no window.
    found = count_plausibility([walk(2.0, 14.0, rest_s=6.0)], np.arange(0.1, 14.0, 0.5))
    assert found.detected == 16
    assert found.expected == pytest.approx(16.0, rel=0.01)


def test_windows_begin_anew_in_each_segment_and_run_over_cut_blocks():
    one, other = walk(2.0, 6.0), walk(2.0, 6.0, segment=1, start_s=100.0)
    found = count_plausibility([one, other], np.arange(0.1, 106.0, 0.5))
    assert found.detected == 16
    cut = [part(one, first, min(first + 75, len(one))) for first in (0, 75, 150, 225)]
    assert count_plausibility([*cut, other], np.arange(0.1, 106.0, 0.5)) == found


def test_nobody_who_rests_has_a_ratio():
    assert np.isnan(count_plausibility([walk(2.0, rest_s=20.0)], np.empty(0)).ratio)
    assert np.isnan(count_plausibility([], np.empty(0)).ratio)
