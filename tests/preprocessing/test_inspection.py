"""An inspection names what a recording holds and every fault that was put into it."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fabricated import Walk, make_walk

from pdr_est.frames import Array
from pdr_est.io.formats.registry import read
from pdr_est.preprocessing.quality.inspection import ChannelInspection, Inspection, inspect_recording
from pdr_est.preprocessing.quality.inspection_text import format_inspection
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, GeoOrigin, Recording, Signal


@pytest.fixture(scope="module")
def walk() -> Walk:
    """A walk with the noise that every sensor has."""
    made = make_walk()
    noise = np.random.default_rng(7).normal(scale=0.01, size=(3, *made.rate.shape))
    return replace(made, gravity=made.gravity + noise[0], rate=made.rate + noise[1], user=made.user + noise[2])


def device(walk: Walk, **changes: Any) -> DeviceRecording:
    return replace(
        DeviceRecording(
            model="TestPhone",
            platform="android",
            specific_force=Signal(walk.time_s, walk.force),
            rotation_rate=Signal(walk.time_s, walk.rate),
            attitude=Signal(walk.time_s, walk.quaternion),
            decisions=("units by metadata",),
            warnings=("something odd",),
        ),
        **changes,
    )


def look(*devices: DeviceRecording, **parts: Any) -> Inspection:
    return inspect_recording(Recording("walk", "test", devices, **parts))


def channel(inspection: Inspection, name: str) -> ChannelInspection:
    return next(channel for channel in inspection.devices[0].channels if channel.name == name)


def findings(inspection: Inspection) -> str:
    return "; ".join(inspection.devices[0].findings)


def test_a_good_recording_has_no_findings(walk: Walk) -> None:
    found = look(device(walk)).devices[0]
    assert found.findings == ()
    assert found.capabilities == ("steps, headings and a track",)
    assert found.overlap is not None
    assert found.overlap.length_s == pytest.approx(7.99)
    assert found.force_norm_mps2 == pytest.approx(9.8, abs=0.3)
    assert found.gravity_cosine == pytest.approx(1.0, abs=0.01)
    assert found.rate_correlation == pytest.approx(1.0, abs=0.01)
    assert (found.decisions, found.warnings) == (("units by metadata",), ("something odd",))


def test_rate_and_jitter_are_measured(walk: Walk) -> None:
    late = walk.time_s + np.where(np.arange(len(walk.time_s)) % 20 == 0, 0.002, 0.0)
    clock = channel(look(device(walk, rotation_rate=Signal(late, walk.rate))), "rotation_rate").clock
    assert clock.rate_hz == pytest.approx(100.0)
    assert clock.jitter_p50_s == pytest.approx(0.0, abs=1e-9)
    assert clock.jitter_p99_s == pytest.approx(0.002)


def test_duplicates_backward_steps_and_gaps_are_counted(walk: Walk) -> None:
    time_s = walk.time_s.copy()
    time_s[100] = time_s[99]
    time_s[200] = time_s[199] - 0.005
    time_s[300:] += 0.75
    found = look(device(walk, specific_force=Signal(time_s, walk.force)))
    clock = channel(found, "specific_force").clock
    assert (clock.duplicates, clock.backward_steps) == (1, 1)
    assert [(gap.start_s, gap.length_s) for gap in clock.gaps] == [(pytest.approx(2.99), pytest.approx(0.76))]
    assert "gap from 2.99 s for 0.76 s" in findings(found)


@pytest.mark.parametrize("limit", [11.0, -11.0])
def test_a_clipped_axis_is_named(walk: Walk, limit: float) -> None:
    force = walk.force.copy()
    force[:, 1] *= 1.5 * np.sign(limit)
    force[:, 1] = np.minimum(force[:, 1], limit) if limit > 0 else np.maximum(force[:, 1], limit)
    found = look(device(walk, specific_force=Signal(walk.time_s, force)))
    assert channel(found, "specific_force").clipped_axes == ("y",)
    assert "axis y hits the end of its range" in findings(found)


def test_an_axis_that_is_clipped_once_for_long_is_named(walk: Walk) -> None:
    rate = walk.rate.copy()
    rate[300:330, 2] = 3.0 * np.abs(rate[:, 2]).max() + np.arange(30) % 7
    limit = float(rate[300:330, 2].min())
    rate[:, 2] = np.minimum(rate[:, 2], limit)
    found = look(device(walk, rotation_rate=Signal(walk.time_s, rate)))
    assert channel(found, "rotation_rate").clipped_axes == ("z",)


@pytest.mark.parametrize("digit", [0.5, 1.0, 2.0])
def test_coarse_digits_are_not_taken_for_clipping(walk: Walk, digit: float) -> None:
    coarse = digit * np.round(walk.force / digit)
    found = look(device(walk, specific_force=Signal(walk.time_s, coarse)))
    assert channel(found, "specific_force").clipped_axes == ()


def test_coarse_and_repeated_values_are_not_taken_for_clipping(walk: Walk) -> None:
    repeated = np.repeat(walk.force[::4], 4, axis=0)
    found = look(device(walk, specific_force=Signal(walk.time_s, repeated)))
    assert channel(found, "specific_force").clipped_axes == ()


def test_a_stuck_sensor_is_found_while_the_other_moves(walk: Walk) -> None:
    rate = walk.rate.copy()
    rate[200:450] = rate[200]
    found = look(device(walk, rotation_rate=Signal(walk.time_s, rate)))
    (stuck,) = channel(found, "rotation_rate").stuck
    assert (stuck.start_s, stuck.length_s) == (pytest.approx(2.0), pytest.approx(2.49))
    assert channel(found, "specific_force").stuck == ()


def test_a_short_standstill_of_values_is_not_stuck(walk: Walk) -> None:
    rate = walk.rate.copy()
    rate[200:380] = rate[200]
    assert channel(look(device(walk, rotation_rate=Signal(walk.time_s, rate))), "rotation_rate").stuck == ()


def held(values: Array, n: int) -> Array:
    return np.repeat(values[::n], n, axis=0)[: len(values)]


def interpolated(walk: Walk, n: int) -> Array:
    return np.stack([np.interp(walk.time_s, walk.time_s[::n], axis[::n]) for axis in walk.rate.T], axis=1)


def test_repeated_and_interpolated_values_reveal_the_true_rate(walk: Walk) -> None:
    found = look(device(walk, rotation_rate=Signal(walk.time_s, held(walk.rate, 4))))
    assert channel(found, "rotation_rate").hidden_by == "repeated"
    assert channel(found, "rotation_rate").effective_rate_hz == pytest.approx(25.0, abs=1.0)
    found = look(device(walk, rotation_rate=Signal(walk.time_s, interpolated(walk, 5))))
    assert channel(found, "rotation_rate").hidden_by == "interpolated"
    assert channel(found, "rotation_rate").effective_rate_hz == pytest.approx(20.0, abs=1.0)
    assert "new ones come at about 20 Hz instead of 100 Hz" in findings(found)


def test_a_zero_gyroscope_is_none(walk: Walk) -> None:
    found = look(device(walk, rotation_rate=Signal(walk.time_s, np.zeros_like(walk.rate)), attitude=None))
    assert "rotation_rate: all values are zero" in findings(found)
    assert "headings and a track are not" in found.devices[0].capabilities[0]


@pytest.mark.parametrize(
    ("missing", "possible"),
    [
        (("rotation_rate",), "no gyroscope: steps and distance are possible, headings and a track are not"),
        (("rotation_rate", "attitude"), "steps and distance are possible, headings and a track are not"),
        (("specific_force",), "steps and a track are not"),
        (("specific_force", "rotation_rate", "attitude"), "nothing can be estimated"),
    ],
)
def test_what_is_possible_without_a_sensor(walk: Walk, missing: tuple[str, ...], possible: str) -> None:
    found = look(device(walk, **dict.fromkeys(missing)))
    assert possible in found.devices[0].capabilities[0]
    assert found.devices[0].overlap is None


def test_sensors_that_never_run_together_are_reported(walk: Walk) -> None:
    found = look(device(walk, rotation_rate=Signal(walk.time_s + 100.0, walk.rate)))
    assert found.devices[0].overlap is None
    assert "never run at the same time" in findings(found)
    assert "a track is not possible" in found.devices[0].capabilities[0]
    assert found.duration_s == pytest.approx(107.99)


def test_a_gyroscope_with_other_signs_than_the_attitude_is_reported(walk: Walk) -> None:
    assert "do not rotate the same way" in findings(look(device(walk, rotation_rate=Signal(walk.time_s, -walk.rate))))


def test_a_single_sample_is_reported() -> None:
    one = Signal(np.array([0.0]), np.array([[0.0, 0.0, 9.8]]))
    found = look(DeviceRecording(specific_force=one))
    assert "a single sample" in findings(found)
    assert channel(found, "specific_force").clock.rate_hz == 0.0


def test_truth_and_fixes_are_summed_up(walk: Walk) -> None:
    fixes = tuple(PositionFix(t, np.zeros(2), np.eye(2) * 16.0, "gps") for t in (1.0, 2.0, 6.5))
    truth = Truth(TruePositions(np.zeros(2), np.zeros((2, 2)), 0.7, "waypoints"), step_count=15, distance_m=9.84)
    found = look(device(walk), truth=truth, fixes=fixes, origin=GeoOrigin(60.0, 24.0), notes=("a note",))
    assert found.fixes == ("3 fixes (gps), 1.0 s to 6.5 s, sigma about 4.0 m",)
    assert found.truth == ("2 positions (waypoints)", "step count 15", "distance 9.8 m")


def test_text_and_json_hold_the_same(walk: Walk) -> None:
    found = look(device(walk), device(walk, name="second"), epoch_s=1_718_030_736.0, origin=GeoOrigin(60.0, 24.0))
    text = format_inspection(found)
    for part in ("2024-06-10 14:45:36 UTC", "device second", "rotation_rate: 800 samples, 100.0 Hz", "something odd"):
        assert part in text
    plain = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert plain["devices"][1]["channels"][0]["clock"]["rate_hz"] == pytest.approx(100.0)
    assert plain["origin_deg"] == [60.0, 24.0]


def test_what_is_not_finite_becomes_null(walk: Walk) -> None:
    assert look(device(walk), epoch_s=float("nan")).to_dict()["start_unix_s"] is None


def test_an_impossible_start_is_described(walk: Walk) -> None:
    assert "1e+20 s since 1970, not a date" in format_inspection(look(device(walk), epoch_s=1e20))


def test_hundreds_of_findings_are_shortened_in_the_text(walk: Walk) -> None:
    time_s = walk.time_s * 100.0
    text = format_inspection(look(device(walk, specific_force=Signal(time_s + np.arange(800) // 2, walk.force))))
    assert len(text.splitlines()) < 60


def test_real_recordings_can_be_inspected(shared_data: Path) -> None:
    found = inspect_recording(read(shared_data / "known-distance/D.csv.gz"))
    assert channel(found, "magnetic_field").hidden_by == "repeated"
    assert channel(found, "specific_force").clock.backward_steps == 1
    assert channel(found, "specific_force").clipped_axes == ()
