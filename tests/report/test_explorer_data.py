"""The data of the page are what was estimated, in few bytes."""

import base64
import json
from dataclasses import replace

import numpy as np
import pytest

from pdr_est.report.packed_columns import PackedColumn, pack_column, pack_floats
from pdr_est.report.walk.explorer_data import explorer_data
from pdr_est.report.walk.fix_residuals import GIVEN, HELD_OUT, MOST_HELD_OUT, fix_residuals
from pdr_est.report.walk.map_extras import NO_EXTRAS, MapExtras
from pdr_est.types.ground_truth import TruePositions


def unpacked(column: PackedColumn) -> np.ndarray:
    """What packed_columns.js does."""
    raw = np.frombuffer(base64.b64decode(column["data"]), dtype="<" + column["type"])
    if column["differences"]:
        return np.cumsum(raw.astype(np.float64)) * column["step"]
    missing = np.isnan(raw) if column["type"].startswith("f") else raw == np.iinfo(raw.dtype).min
    return np.where(missing, np.nan, raw * column["step"])


@pytest.mark.parametrize("size", [1.0, 30.0, 3e4, 3e6, 1e12])
def test_a_packed_column_is_right_to_half_a_step(size: float) -> None:
    values = size * np.random.default_rng(0).standard_normal(500)
    assert np.abs(unpacked(pack_column(values, 1e-3)) - values).max() <= 0.5e-3 * (1 + 1e-9) + 1e-15 * size
    values[::7] = np.nan
    assert np.allclose(unpacked(pack_column(values, 1e-3)), values, rtol=1e-15, atol=0.501e-3, equal_nan=True)


def test_a_column_takes_as_few_bytes_as_it_can() -> None:
    times_s = 1_000.0 + 0.5 * np.arange(1000)
    assert len(pack_column(times_s, 1e-3)["data"]) > 4 * 1000
    assert len(pack_column(times_s - 1000.0, 1e-3)["data"]) < 3 * 1000
    assert len(pack_column(np.full(1000, 2.0), 1.0)["data"]) < 1.4 * 1000
    assert unpacked(pack_column([], 1.0)).shape == (0,)
    assert unpacked(pack_floats([1e-9, np.nan, 1e9])) == pytest.approx([1e-9, np.nan, 1e9], rel=1e-6, nan_ok=True)


def test_the_data_hold_every_pose_and_sample(make_walk) -> None:
    walk, recording = make_walk(steps=80, devices=("1L", "2R"))
    truth = recording.truth.positions
    data = json.loads(json.dumps(explorer_data(walk, fix_residuals(walk, truth, None), None, False, NO_EXTRAS)))
    for device in data["devices"]:
        track = walk.track.of_device(device["name"])
        poses = {name: unpacked(column) for name, column in device["poses"].items()}
        assert np.allclose(poses["time_s"], track.time_s, atol=1e-3)
        assert np.allclose(np.column_stack([poses["x_m"], poses["y_m"]]), track.position_m, atol=1e-3)
        assert np.allclose(poses["cxy_m2"], track.covariance_m2[:, 0, 1], rtol=1e-6)
        assert np.allclose(np.radians(poses["heading_deg"]), track.heading_rad, atol=1e-3)
        assert poses["mode"].tolist() == track.mode.tolist()
    level = walk.devices[1].level[0]
    (segment,) = data["signals"][1]["segments"]
    assert np.allclose(unpacked(segment["values"]), level.vertical_mps2, atol=0.0051)
    assert (segment["begin_s"], segment["end_s"]) == (level.time_s[0], level.time_s[-1])
    assert data["truth"] is None


def test_an_hour_with_two_phones_is_small(make_walk) -> None:
    walk, _ = make_walk(steps=6900, devices=("1L", "2R"))
    assert len(json.dumps(explorer_data(walk, [], None, True, NO_EXTRAS))) < 2_500_000


def test_fixes_that_were_given_are_told_from_those_held_out(make_walk) -> None:
    walk, recording = make_walk(steps=100)
    truth = recording.truth.positions
    given, held_out = fix_residuals(walk, truth, truth.position_m)
    assert (given.kind, held_out.kind) == (GIVEN, HELD_OUT)
    assert given.bound_m == pytest.approx(0.7 * np.sqrt(5.991), rel=1e-3)  # of the fix alone
    reached_m, covariance_m2 = walk.track.at(truth.time_s)
    assert held_out.distance_m == pytest.approx(np.linalg.norm(truth.position_m - reached_m, axis=1))
    largest_m2 = np.linalg.eigvalsh(covariance_m2)[:, 1] + truth.sigma_m**2
    assert held_out.bound_m == pytest.approx(np.sqrt(5.991464547 * largest_m2))


def test_fixes_only_aligned_with_count_as_held_out(make_walk) -> None:
    walk, _ = make_walk(steps=100)
    assert [one.kind for one in fix_residuals(replace(walk, fixes_used=False), None, None)] == [HELD_OUT]


def test_dense_truth_is_thinned(make_walk) -> None:
    walk, _ = make_walk(steps=100)
    time_s = np.linspace(3.0, 50.0, 5000)
    truth = TruePositions(time_s, np.zeros((5000, 2)), 0.01, "poses")
    (held_out,) = fix_residuals(replace(walk, fixes=()), truth, truth.position_m)
    assert len(held_out.time_s) == MOST_HELD_OUT
    assert held_out.time_s[[0, -1]].tolist() == [3.0, 50.0]


def test_variants_and_background_are_passed_on(make_walk) -> None:
    walk, _ = make_walk(steps=20)
    extras = MapExtras({"alone": walk.track}, {"kind": "lines"})
    data = explorer_data(walk, [], None, True, extras)
    assert [one["name"] for one in data["variants"]] == ["alone"]
    assert data["background"] == {"kind": "lines"}


def test_a_day_is_thinned_to_extremes_in_time(make_walk, monkeypatch: pytest.MonkeyPatch) -> None:
    walk, _ = make_walk(steps=200)
    monkeypatch.setattr("pdr_est.report.walk.explorer_data.MOST_SAMPLES", 700)
    level = walk.devices[0].level[0]
    (segment,) = explorer_data(walk, [], None, True, NO_EXTRAS)["signals"][0]["segments"]
    values = unpacked(segment["values"])
    assert 500 < len(values) <= 702
    assert values.max() == pytest.approx(level.vertical_mps2.max(), abs=0.006)
    assert values.min() == pytest.approx(level.vertical_mps2.min(), abs=0.006)
    times_s = np.linspace(segment["begin_s"], segment["end_s"], len(values))
    standing = level.vertical_mps2[level.time_s < 2.5]
    assert np.abs(values[times_s < 2.4]).max() <= np.abs(standing).max() + 0.006
