"""The bias of the gyroscope that a standing walker shows."""

from itertools import pairwise

import numpy as np
import pytest
from signals import RATE_HZ, imu, run

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.front_end.attitude import AttitudeParams, VqfAttitude
from pdr_est.front_end.signal.standing_bias import StandingBias, StandingBiasParams
from pdr_est.testing.partitions import cut_finely, cut_randomly
from pdr_est.types.sensors import ImuBlock, LevelBlock

UP = np.array([0.0, 0.6, 0.8])


def hand(rng: np.random.Generator, seconds: float, bias_radps: Array) -> tuple[Array, Array]:
    """Specific force and rate of a phone in a standing hand, which turns at two thirds of a degree a second or so."""
    time_s = np.arange(round(seconds * RATE_HZ))[:, None] / RATE_HZ
    angular = 2.0 * np.pi * rng.uniform(0.1, 1.5, (12, 1, 3))
    phase = angular * time_s + rng.uniform(0.0, 2.0 * np.pi, (12, 1, 3))
    angle = np.deg2rad(0.05) * np.sin(phase).sum(axis=0)
    force = STANDARD_GRAVITY_MPS2 * (UP + np.cross(angle, UP)) + 0.05 * rng.standard_normal(angle.shape)
    return force, np.deg2rad(0.05) * (angular * np.cos(phase)).sum(axis=0) + bias_radps


def found(force: Array, rate: Array) -> tuple[Array, Array]:
    stage = StandingBias(RATE_HZ, StandingBiasParams())
    mean, variance = stage.push(0, np.linalg.norm(force, axis=1), rate)
    return mean[-1], np.sqrt(variance[-1])


@pytest.mark.parametrize("bias_deg_per_s", [-1.0, 0.0, 0.5, 1.0])
@pytest.mark.parametrize("seed", range(3))
def test_a_minute_with_the_phone_in_the_hand_shows_the_bias(seed: int, bias_deg_per_s: float) -> None:
    bias = np.deg2rad(bias_deg_per_s) * np.array([0.2, 1.0, -0.5])
    force, rate = hand(np.random.default_rng(seed), 60.5, bias)
    mean, sigma = found(force, rate)
    assert np.rad2deg(np.abs(mean - bias)).max() < 0.35
    assert (np.abs(mean - bias) < 2.0 * sigma + np.deg2rad(0.05)).all()


def test_a_large_bias_needs_more_than_one_stretch_for_it_may_be_a_slow_turn() -> None:
    bias = np.deg2rad(2.0) * UP
    force, rate = hand(np.random.default_rng(9), 181.0, bias)
    mean, _ = found(force, rate)
    assert np.rad2deg(np.abs(mean - bias)).max() < 0.2


def test_a_standing_walker_who_turns_round_shows_no_bias() -> None:
    force, rate = hand(np.random.default_rng(4), 20.5, np.zeros(3))
    rate[300:500] += np.deg2rad(22.5) * UP  # by a quarter turn in four seconds
    mean, _ = found(force, rate)
    assert np.rad2deg(np.abs(mean)).max() < 0.1


def test_a_walker_who_turns_slowly_for_some_seconds_shows_no_bias() -> None:
    force, rate = hand(np.random.default_rng(4), 3.0, np.deg2rad(1.5) * UP)  # by a few degrees, as people sway
    mean, sigma = found(force, rate)
    assert np.rad2deg(np.abs(mean)).max() < 0.15
    assert np.rad2deg(sigma).max() > 0.1


def test_what_was_found_is_forgotten_slowly_for_what_is_shown_later() -> None:
    rng = np.random.default_rng(5)
    parts = [hand(rng, 100.0, np.full(3, np.deg2rad(value))) for value in (0.5, -0.5, -0.5, -0.5)]
    force, rate = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    mean, _ = found(force, rate)
    assert np.rad2deg(mean) == pytest.approx(-0.5, abs=0.1)


def with_bias(seconds_of_standing: float) -> ImuBlock:
    """Standing, then a minute of shaking as a walker's hand does it, without any turn but that of the bias."""
    rng = np.random.default_rng(6)
    bias = np.deg2rad(1.0) * UP
    force, rate = hand(rng, seconds_of_standing, bias)
    steps = 2.0 * np.sin(2.0 * np.pi * 2.0 * np.arange(round(60 * RATE_HZ)) / RATE_HZ)
    walking, turning = (STANDARD_GRAVITY_MPS2 + steps)[:, None] * UP, np.tile(bias, (len(steps), 1))
    turning += np.deg2rad(20.0) * rng.standard_normal(turning.shape)
    return imu(np.concatenate([force, walking]), np.concatenate([rate, turning]))


def drift_deg(block: ImuBlock, **parameters: object) -> float:
    settings = AttitudeParams(standing=StandingBiasParams(**parameters))  # type: ignore[arg-type]
    (level,) = run(VqfAttitude(RATE_HZ, settings), [block])
    yaw = np.unwrap(level.yaw_rad)
    return float(np.rad2deg(yaw[-1] - yaw[-round(60 * RATE_HZ)]))


def test_the_yaw_of_a_walk_does_not_drift_after_standing() -> None:
    assert abs(drift_deg(with_bias(60.0), enabled=False)) > 40.0
    assert abs(drift_deg(with_bias(60.0))) < 20.0


def test_without_standing_nothing_changes() -> None:
    assert drift_deg(with_bias(0.0)) == pytest.approx(drift_deg(with_bias(0.0), enabled=False), abs=1e-9)


@pytest.mark.slow
def test_the_bias_is_the_same_however_the_samples_are_cut() -> None:
    block = with_bias(62.34)

    def bias_of(blocks: list[ImuBlock]) -> tuple[Array, Array]:
        levels: list[LevelBlock] = run(VqfAttitude(RATE_HZ, AttitudeParams()), blocks)
        found = [level.turn_bias_radps for level in levels if level.turn_bias_radps is not None]
        return np.concatenate([level.yaw_rad for level in levels]), np.concatenate(found)

    whole = bias_of([block])
    assert np.ptp(whole[1][:, 0]) > np.deg2rad(0.5)
    for blocks in (cut_randomly([block], np.random.default_rng(7)), cut_finely([block])):
        for one, other in zip(bias_of(blocks), whole, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("first_index", [1, 30, 49, 50])
def test_after_a_gap_too_the_bias_is_the_same_however_the_samples_are_cut(first_index: int) -> None:
    """The second segment begins within a window, and its first pieces end before the next window begins."""
    force, rate = hand(np.random.default_rng(8), 24.0, np.deg2rad(2.0) * UP)
    length, half, resumes = np.linalg.norm(force, axis=1), 600, 1000 + first_index

    def found_in(pieces: list[int]) -> Array:
        stage = StandingBias(RATE_HZ, StandingBiasParams())
        stage.push(0, length[:half], rate[:half])
        edges = [half, *(half + piece for piece in pieces), len(length)]
        parts = [stage.push(resumes + a - half, length[a:b], rate[a:b]) for a, b in pairwise(edges)]
        sizes = np.diff(edges)
        means = [np.broadcast_to(mean, (size, 3)) for (mean, _), size in zip(parts, sizes, strict=True)]
        return np.concatenate(means)

    whole = found_in([])
    assert np.ptp(whole[:, 1]) > 0.0
    for pieces in ([1], [5, 7, 300], list(range(1, 600))):
        np.testing.assert_array_equal(found_in(pieces), whole)
