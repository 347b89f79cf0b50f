"""The mode recogniser: its evidence and its chain against exact answers, and what it makes of simulated phones."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pdr_est.config import Config
from pdr_est.frames import Array
from pdr_est.front_end.mode import AutoModeParams, HmmModeRecogniser
from pdr_est.front_end.mode.hidden_markov import STATES, ModeBelief, backward_likelihood
from pdr_est.front_end.mode.window_features import (
    COLUMNS,
    MODES,
    hop_means,
    mode_likelihoods,
    sample_columns,
    window_features,
)
from pdr_est.front_end.signal.blocks import join, part
from pdr_est.front_end.signal.vectors import norm
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import SimulatedWalk, mmpdr_indoor, mmpdr_mode_walks, simulate_walk
from pdr_est.types.recording import Signal
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

RATE_HZ = 50.0
HOLDING, SWING, POCKET, UNKNOWN = (
    CarryingMode.HOLDING,
    CarryingMode.SWING,
    CarryingMode.POCKET,
    CarryingMode.UNKNOWN,
)


def level_of(walk: SimulatedWalk) -> LevelBlock:
    return join(analyse_recording(walk.recording, Config())[0].level)


def relabelled(*blocks: LevelBlock) -> LevelBlock:
    stage = HmmModeRecogniser(RATE_HZ, AutoModeParams())
    return join([done for block in blocks for done in stage.push(block)] + stage.flush())


def standing(seconds: float, like: LevelBlock) -> LevelBlock:
    """A phone at rest in a new segment, the way it lies at the start of another block, a second after its end."""
    count = int(seconds * RATE_HZ)
    still = part(like, 0, 1)
    block = join([still] * count)
    time_s = float(like.time_s[-1]) + 1.0 + np.arange(count) / RATE_HZ
    zero = np.zeros((count, 3))
    return replace(
        block,
        segment=like.segment + 1,
        time_s=time_s,
        acceleration_mps2=zero,
        rotation_rate_radps=zero,
        vertical_mps2=np.zeros(count),
    )


def pendulum(radius_m: float, shake_mps2: float = 0.0) -> LevelBlock:
    """A phone that swings about its x axis, its joint straight above; shaken besides at another frequency."""
    time_s = np.arange(0.0, 9.6, 1.0 / RATE_HZ)
    angle = 0.4 * np.sin(2.0 * np.pi * time_s)
    speed = 0.4 * 2.0 * np.pi * np.cos(2.0 * np.pi * time_s)
    spin = -((2.0 * np.pi) ** 2) * angle
    none = np.zeros(len(time_s))
    up = np.column_stack([none, np.sin(angle), np.cos(angle)])
    acceleration = np.column_stack([none, radius_m * spin, radius_m * speed**2])
    acceleration[:, 1] += shake_mps2 * np.sin(2.0 * np.pi * 2.5 * time_s)
    rate = np.column_stack([speed, none, none])
    vertical = (acceleration * up).sum(axis=1)
    mode = np.zeros(len(time_s), dtype=np.int8)
    return LevelBlock(0, 0, time_s, up, acceleration, vertical, none, rate, none, mode, none)


def seen(block: LevelBlock) -> Array:
    """Swing, radius and frequency of a window over all of a block but its beginning."""
    means = hop_means(sample_columns([block]), 10, RATE_HZ, np.empty((0, COLUMNS)))
    mean = means[8:].mean(axis=0, keepdims=True)
    return np.exp(window_features(mean, norm(mean[:, :3]))[:, 0])


@pytest.mark.parametrize("shake_mps2", [0.0, 3.0])
def test_the_radius_is_that_of_the_pendulum(shake_mps2):
    _, radius_m, *_ = seen(pendulum(0.45, shake_mps2))
    x = np.pi * 1.0 * 0.2  # averaging over hops of 0.2 s at 1 Hz
    assert radius_m == pytest.approx(0.45 * x / np.tan(x), rel=0.02)


def test_the_swing_is_that_of_the_pendulum():
    swing_rad, *_ = seen(pendulum(0.45))
    assert swing_rad == pytest.approx(0.4 / np.sqrt(2.0), rel=0.05)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [0.0, 1e-12, 1e6, 1e9])
def test_evidence_of_any_size_is_finite_and_above_zero(size):
    rng = np.random.default_rng(0)
    means = size * rng.standard_normal((50, COLUMNS))
    likelihood = mode_likelihoods(means, means[::-1], 0.4)
    assert np.isfinite(likelihood).all()
    assert (likelihood > 0.0).all()


def test_the_chain_is_the_sum_over_all_ways_through_it():
    rng = np.random.default_rng(1)
    rows, states, ahead = 6, STATES, 3
    change, likelihood = rng.uniform(0.05, 0.6, rows), rng.uniform(0.1, 1.0, (states, rows))
    decided = rows - ahead
    belief = ModeBelief().forward(change[:decided], likelihood[:, :decided])
    belief *= backward_likelihood(change, likelihood, decided, ahead)
    belief /= belief.sum(axis=0)
    for row in range(decided):
        weight = np.zeros(states)
        for way in product(range(states), repeat=row + ahead + 1):
            p = 1.0 / states
            for k, state in enumerate(way):
                if k > 0:
                    leave = change[k] / (states - 1)
                    p *= 1.0 - change[k] if state == way[k - 1] else leave
                p *= likelihood[state, k]
            weight[way[row]] += p
        assert belief[:, row] == pytest.approx(weight / weight.sum())


@pytest.mark.parametrize("mode", [HOLDING, SWING, POCKET])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_mode_is_found_from_the_first_step_through_turns_and_standing(mode, seed):
    walk = simulate_walk(mmpdr_indoor(mode, seed=seed))
    level = level_of(walk)
    walking = (level.time_s >= walk.steps.time_s[0]) & (level.time_s <= walk.steps.time_s[-1])
    assert (level.mode[walking] == mode).mean() > 0.99
    assert level.mode[-1] == mode
    assert level.mode_probability[walking].mean() > 0.9


@pytest.mark.parametrize("mode", [HOLDING, SWING, POCKET])
def test_it_does_not_matter_how_the_phone_lies_in_hand_or_pocket(mode):
    walk = simulate_walk(mmpdr_indoor(mode, seed=1))
    device = walk.recording.devices[0]
    for turn in Rotation.random(4, random_state=3):
        force, rate = (
            Signal(signal.time_s, turn.apply(signal.values))
            for signal in (device.specific_force, device.rotation_rate)
        )
        turned = replace(device, specific_force=force, rotation_rate=rate)
        level = join(analyse_recording(replace(walk.recording, devices=(turned,)), Config())[0].level)
        walking = (level.time_s >= walk.steps.time_s[0]) & (level.time_s <= walk.steps.time_s[-1])
        assert (level.mode[walking] == mode).mean() > 0.98


def test_changes_are_placed_within_the_hands_movement():
    walk = simulate_walk(mmpdr_mode_walks(3, 0)[1])
    level, modes = level_of(walk), walk.devices[0].modes
    found_s = level.time_s[1:][(np.diff(level.mode) != 0) & (level.mode[:-1] != UNKNOWN)]
    begins_s, ends_s = modes.start_s[1::2], modes.start_s[2::2]
    assert len(found_s) == len(begins_s)
    assert ((found_s > begins_s - 0.25) & (found_s < ends_s + 0.25)).all()


def test_nothing_is_known_before_anybody_walks():
    like = level_of(simulate_walk(mmpdr_indoor(HOLDING)))
    level = relabelled(standing(10.0, like))
    assert (level.mode == UNKNOWN).all()
    assert level.mode_probability == pytest.approx(0.25, abs=1e-6)


def test_the_mode_outlasts_a_gap_and_fades_over_a_long_one():
    walked = level_of(simulate_walk(mmpdr_indoor(POCKET)))
    after = standing(3.0, walked)
    soon = relabelled(walked, after)
    assert soon.mode[-1] == POCKET
    assert soon.mode_probability[-1] > 0.9
    late = relabelled(walked, replace(after, time_s=after.time_s + 600.0))
    assert late.mode_probability[-1] < 0.3


def test_a_phone_without_gyroscope_has_no_mode():
    walked = level_of(simulate_walk(mmpdr_indoor(POCKET)))
    level = relabelled(replace(walked, rotation_rate_radps=np.full((len(walked), 3), np.nan)))
    assert (level.mode == UNKNOWN).all()


def test_every_sample_is_labelled_once_in_its_order():
    walked = level_of(simulate_walk(mmpdr_indoor(SWING)))
    level = relabelled(walked)
    assert np.array_equal(level.time_s, walked.time_s)
    assert set(np.unique(level.mode)) <= {UNKNOWN, *MODES}


@pytest.mark.parametrize(("spoilt", "ahead"), [(0, 0), (0, 3), (3, 0), (1, 1)])
def test_a_short_look_around_labels_every_sample_once(spoilt, ahead):
    walked = level_of(simulate_walk(mmpdr_indoor(SWING)))
    stage = HmmModeRecogniser(RATE_HZ, AutoModeParams(spoilt_hops=spoilt, ahead_hops=ahead))
    pieces = [part(walked, start, min(start + 7, len(walked))) for start in range(0, len(walked), 7)]
    found = [done for piece in pieces for done in stage.push(piece)] + stage.flush()
    assert all(len(block.mode) == len(block) == len(block.mode_probability) for block in found)
    assert np.array_equal(join(found).time_s, walked.time_s)


def test_no_label_is_later_than_the_latency():
    walked = level_of(simulate_walk(mmpdr_indoor(SWING)))
    stage = HmmModeRecogniser(RATE_HZ, AutoModeParams())
    late_s = [
        float(walked.time_s[i] - done.time_s[0])
        for i in range(len(walked))
        for done in stage.push(part(walked, i, i + 1))
    ]
    assert stage.latency_s - 1.5 / RATE_HZ < max(late_s) < stage.latency_s + 1e-6
