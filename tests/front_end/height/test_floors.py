"""Floors by the air pressure: found, timed, and not invented."""

import numpy as np
import pytest
from buildings import Visit, pressure_as_claimed, pressure_of, visit
from scipy.stats import chi2

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.front_end.height import HeightParams, height_profile
from pdr_est.types.height import HeightProfile, MoveKind
from pdr_est.types.recording import Signal


def profile_of(walk: Visit, seed: int, pressed: bool = False, steps: bool = True) -> HeightProfile:
    found = height_profile(pressure_of(walk, seed, pressed), walk.step_time_s if steps else None)
    assert found is not None
    return found


def share_on_the_right_floor(walk: Visit, found: HeightProfile) -> float:
    return float(np.mean(found.floor[found.nearest(walk.time_s)] == walk.floor))


def test_most_of_the_time_is_on_the_right_floor() -> None:
    shares = []
    for seed in range(12):
        walk = visit(seed, 10.0)
        shares.append(
            share_on_the_right_floor(walk, profile_of(walk, seed, pressed=seed % 2 == 1, steps=seed % 3 > 0))
        )
    assert np.mean(np.array(shares) >= 0.98) >= 11 / 12
    assert np.mean(shares) >= 0.98


def test_a_change_of_floor_is_told_within_five_seconds() -> None:
    walk = visit(3, 10.0)
    found = profile_of(walk, 3)
    true_s = walk.time_s[1:][np.diff(walk.floor) != 0]
    told_s = found.time_s[1:][np.diff(found.floor) != 0]
    assert len(true_s) > 2
    assert np.abs(told_s[None, :] - true_s[:, None]).min(axis=1).max() <= 5.0


@pytest.mark.parametrize("pressed", [False, True])
def test_no_floor_is_invented_in_an_hour_on_the_flat(pressed: bool) -> None:
    for seed in (20, 21, 22):
        assert set(profile_of(visit(seed, 60.0, flat=True), seed, pressed).floor.tolist()) == {0}


def normalised(walk: Visit, pressure: Signal) -> Array:
    """Errors (n,) of the height over their claimed standard deviations, at the times of the walk."""
    found = height_profile(pressure, walk.step_time_s)
    assert found is not None
    places = found.nearest(walk.time_s)
    return (found.height_m[places] - walk.height_m) / found.sigma_m[places]


def test_the_height_is_as_good_as_its_sigma_says() -> None:
    """The pressure is disturbed as the parameters say: one error of each walk, at its middle or its end."""
    walks = [visit(seed, 6.0) for seed in range(30, 54)]
    errors = [normalised(walk, pressure_as_claimed(walk, seed)) for seed, walk in enumerate(walks)]
    least, most = chi2.ppf([0.0005, 0.9995], len(walks)) / len(walks)
    for place in (0.5, 1.0):
        squared = [error[int(place * (len(error) - 1))] ** 2 for error in errors]
        assert least < np.mean(squared) < most


def test_steady_weather_is_within_the_sigma() -> None:
    """Up to 1.5 hPa an hour, doors and noise of a phone are less than a random walk may be."""
    walks = [visit(seed, 6.0) for seed in range(30, 36)]
    assert np.mean([np.mean(normalised(walk, pressure_of(walk, 30 + k)) ** 2) for k, walk in enumerate(walks)]) < 1.0


def test_stairs_and_lift_are_told_apart_by_speed_and_steps() -> None:
    time_s = np.arange(0.0, 200.0, 0.1)
    stairs, ride = np.clip((time_s - 60.0) * 0.3, 0.0, 3.6), np.clip((time_s - 140.0) * 1.5, 0.0, 7.2)
    stepping = np.concatenate(
        [np.arange(1.0, 72.0, 0.55), np.arange(80.0, 135.0, 0.55), np.arange(150.0, 199.0, 0.55)]
    )
    walk = Visit(time_s, stairs + ride, np.zeros(len(time_s)), stepping)
    first, second = profile_of(walk, 5).moves
    assert (first.kind, second.kind) == (MoveKind.STAIRS, MoveKind.LIFT)
    assert first.rise_m == pytest.approx(3.6, abs=0.5)
    assert second.rise_m == pytest.approx(7.2, abs=0.6)
    assert (first.begin_s, second.begin_s) == (pytest.approx(60.0, abs=3.0), pytest.approx(140.0, abs=3.0))


def test_standing_on_an_escalator_has_no_steps() -> None:
    time_s = np.arange(0.0, 120.0, 0.1)
    walk = Visit(
        time_s,
        np.clip((time_s - 50.0) * 0.25, 0.0, 5.0),
        np.zeros(len(time_s)),
        np.concatenate([np.arange(1.0, 49.0, 0.55), np.arange(71.0, 119.0, 0.55)]),
    )
    (move,) = profile_of(walk, 6).moves
    assert move.kind is MoveKind.ESCALATOR


def test_the_building_tells_how_high_its_storeys_are() -> None:
    """Rises of 4.5 m by themselves make 9 m two storeys, though 2.5 usual ones are as near to three."""
    time_s = np.arange(0.0, 400.0, 0.1)
    height_m = sum(np.clip((time_s - begin) * 0.3, 0.0, 4.5) for begin in (50.0, 130.0))
    height_m = height_m + np.clip((time_s - 260.0) * 1.5, 0.0, 9.0)
    walk = Visit(time_s, height_m, np.rint(height_m / 4.5), np.arange(1.0, 250.0, 0.55))
    found = profile_of(walk, 7)
    assert found.floor[-1] == 4
    assert found.floor_probability[-1] > 0.5


@pytest.mark.parametrize("value", [np.nan, 0.0])
def test_a_pressure_without_a_usable_sample_tells_nothing(value: float) -> None:
    assert height_profile(Signal(np.arange(5.0), np.full((5, 1), value)), None) is None


def test_gaps_of_the_pressure_are_bridged() -> None:
    walk = visit(8, 8.0, flat=True)
    signal = pressure_of(walk, 8)
    kept = (signal.time_s < 100.0) | (signal.time_s > 160.0)
    found = height_profile(Signal(signal.time_s[kept], signal.values[kept]), walk.step_time_s)
    assert found is not None
    assert np.array_equal(np.unique(np.diff(found.time_s)), [1.0])
    assert set(found.floor.tolist()) == {0}


def test_the_order_of_samples_does_not_matter() -> None:
    walk = visit(9, 5.0)
    signal = pressure_of(walk, 9)
    order = np.random.default_rng(0).permutation(len(signal.time_s))
    straight, mixed = (
        height_profile(one, walk.step_time_s) for one in (signal, Signal(signal.time_s[order], signal.values[order]))
    )
    assert straight is not None
    assert mixed is not None
    np.testing.assert_allclose(mixed.height_m, straight.height_m, atol=1e-6)


def test_parameters_are_checked() -> None:
    with pytest.raises(ConfigError, match="storey_m"):
        HeightParams(storey_m=-1.0)
