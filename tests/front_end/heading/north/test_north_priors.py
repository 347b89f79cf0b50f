"""Headings against north: exact against the truth of simulated walks, and honest where they are disturbed."""

from dataclasses import replace

import numpy as np
import pytest
from signals import PAUSE, corner_walk, run, step

from pdr_est.config import Config
from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.north import NorthParams, NorthPriors, NorthReference, north_reference
from pdr_est.front_end.heading.north.correlated_error import CorrelatedHeadingError
from pdr_est.front_end.heading.north.declination import magnetic_declination
from pdr_est.front_end.heading.north.pointing import final_pointings
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import (
    NO_SENSOR_ERRORS,
    DeviceParams,
    EarthField,
    HeldPhone,
    PathParams,
    Scenario,
    SensorParams,
    SimulatedWalk,
    WalkerGaitParams,
    simulate_walk,
)
from pdr_est.testing import check_partition, check_stage
from pdr_est.types.findings import FindingKind
from pdr_est.types.measurements import HeadingPrior
from pdr_est.types.recording import GeoOrigin, Recording
from pdr_est.types.sensors import AttitudeReference
from pdr_est.types.steps import CarryingMode, Step

PARAMETERS = NorthParams()
DEVICE = NorthReference("device")
DRIFT = 0.02


def north_walk(tilt_rad: float = 0.6, declination_rad: float = 0.3) -> SimulatedWalk:
    """A corner with a perfect magnetometer and a perfect attitude of the phone."""
    sensors = SensorParams(magnetometer=NO_SENSOR_ERRORS, record_attitude=True)
    return simulate_walk(
        Scenario(
            path=PathParams(vertices_m=((0.0, 0.0), (12.0, 5.0), (4.0, 18.0))),
            gait=WalkerGaitParams(pauses=PAUSE),
            devices=(DeviceParams(carry=HeldPhone(tilt_rad=tilt_rad), sensors=sensors),),
            earth=EarthField(declination_rad=declination_rad),
        )
    )


def absolute(recording: Recording, **north: object) -> list[HeadingPrior]:
    config = Config().replace({f"heading.north.{key}": value for key, value in north.items()})
    (walk,) = analyse_recording(recording, config)
    return [one for one in walk.odometry if isinstance(one, HeadingPrior) and not one.relative]


def referenced(recording: Recording, reference: AttitudeReference) -> Recording:
    return replace(recording, devices=(replace(recording.devices[0], attitude_reference=reference),))


def errors_rad(priors: list[HeadingPrior], walk: SimulatedWalk) -> Array:
    time_s = np.array([prior.time_s for prior in priors])
    return wrap_angle(np.array([prior.heading_rad for prior in priors]) - walk.heading_at(time_s - 0.25))


@pytest.mark.parametrize("tilt_rad", [0.0, 0.6, 1.4])
def test_a_phone_flat_or_upright_in_front_tells_the_walkers_heading(tilt_rad: float) -> None:
    walk = north_walk(tilt_rad)
    priors = absolute(referenced(walk.recording, AttitudeReference.TRUE_NORTH))
    assert len(priors) >= 4
    assert np.rad2deg(np.abs(np.median(errors_rad(priors, walk)))) < 3.0


@pytest.mark.parametrize("declination_rad", [0.3, -0.2])
def test_the_magnetometer_is_off_by_the_declination_where_the_place_is_unknown(declination_rad: float) -> None:
    walk = north_walk(declination_rad=declination_rad)
    priors = absolute(walk.recording)  # whose attitude counts from what nobody stated
    # Magnetic north is the declination clockwise of true north: against it, the walker is turned the other way.
    assert np.median(errors_rad(priors, walk)) == pytest.approx(declination_rad, abs=0.06)


def test_the_declination_at_the_place_is_taken_off() -> None:
    declination_rad, sigma_rad = magnetic_declination(64.1, -21.9, 1.6e9)  # Reykjavik, about 12 degrees west
    assert np.rad2deg(declination_rad) == pytest.approx(-12.0, abs=1.5)
    walk = north_walk(declination_rad=declination_rad)
    recording = replace(walk.recording, origin=GeoOrigin(64.1, -21.9), epoch_s=1.6e9)
    priors = absolute(recording)
    assert np.median(errors_rad(priors, walk)) == pytest.approx(0.0, abs=0.06)
    unplaced = absolute(walk.recording)
    assert priors[0].sigma_rad < unplaced[0].sigma_rad
    assert priors[0].sigma_rad ** 2 + PARAMETERS.sigma_declination_rad**2 == pytest.approx(
        unplaced[0].sigma_rad ** 2 + sigma_rad**2
    )


@pytest.mark.parametrize(
    ("latitude_deg", "longitude_deg", "expected_deg"), [(80, 0, -1.28), (0, 120, 0.16), (-80, 240, 69.36)]
)
def test_the_model_gives_its_published_values(latitude_deg: float, longitude_deg: float, expected_deg: float) -> None:
    found_rad, sigma_rad = magnetic_declination(latitude_deg, longitude_deg, 1577836800.0)  # 2020.0, WMM 2020
    assert np.rad2deg(found_rad) == pytest.approx(expected_deg, abs=0.01)
    undated = magnetic_declination(latitude_deg, longitude_deg, None)
    assert undated[1] > sigma_rad
    assert np.isfinite(magnetic_declination(latitude_deg, longitude_deg, 4e9)).all()  # beyond the model


def test_the_first_prior_has_the_whole_uncertainty_and_comes_with_the_first_step() -> None:
    walk = north_walk()
    priors = absolute(walk.recording)
    (steps,) = (one.steps for one in analyse_recording(walk.recording, Config()))
    assert priors[0].time_s == steps[0].event.time_s
    p = PARAMETERS
    parts = (p.sigma_hold_rad, p.sigma_calibration_rad, p.sigma_declination_rad, p.sigma_disturbance_rad)
    assert priors[0].sigma_rad == pytest.approx(np.linalg.norm([*parts, p.sigma_step_rad / 2.0]), rel=0.02)


def test_no_source_no_prior() -> None:
    walk = north_walk()
    assert absolute(walk.recording, source="none") == []
    assert absolute(walk.recording, source="device") == []  # its yaw counts from what nobody stated
    bare = replace(walk.recording.devices[0], magnetic_field=None)
    assert absolute(replace(walk.recording, devices=(bare,))) == []
    assert north_reference(walk.recording.devices[0], None, None, PARAMETERS) == NorthReference(
        "magnetometer", 0.0, PARAMETERS.sigma_declination_rad
    )
    arbitrary = replace(bare, attitude_reference=AttitudeReference.ARBITRARY)
    assert north_reference(arbitrary, None, None, PARAMETERS) is None


def test_a_field_that_cannot_be_the_earths_tells_nothing() -> None:
    walk = north_walk()
    device = walk.recording.devices[0]
    assert device.magnetic_field is not None
    for factor in (0.2, 5.0):  # not calibrated, or in another unit
        field = replace(device.magnetic_field, values=factor * device.magnetic_field.values)
        assert absolute(replace(walk.recording, devices=(replace(device, magnetic_field=field),))) == []


def held_steps(recorded_yaw_deg: Array, mode: CarryingMode = CarryingMode.HOLDING) -> list[Step]:
    """Steps straight on, of a phone that lies flat, top ahead, with the yaw by its own attitude.

    The acceleration forward is a quarter of a step ahead of the vertical one.
    """
    steps = []
    phase = 2.0 * np.pi * (np.arange(30) + 0.5) / 30
    for number, yaw_deg in enumerate(recorded_yaw_deg):
        made = step(0.5 * (number + 1), 0.5 * number, heading_rad=0.4, frequency_hz=2.0)
        level = np.zeros(len(made.samples))
        samples = replace(
            made.samples,
            up=np.tile([0.0, 0.0, 1.0], (len(level), 1)),
            acceleration_mps2=np.stack([level, -np.sin(phase), 2.0 * np.cos(phase)], axis=1),
            vertical_mps2=2.0 * np.cos(phase),
            yaw_rad=level,
            recorded_yaw_rad=level + np.deg2rad(yaw_deg),
        )
        steps.append(replace(made, samples=samples, event=replace(made.event, mode=mode)))
    return steps


def turned_samples(one: Step) -> Step:
    """A step of a walker who goes along the x axis of the phone, to the right of its top."""
    x, y, z = one.samples.acceleration_mps2.T
    return replace(one, samples=replace(one.samples, acceleration_mps2=np.stack([y, -x, z], axis=1)))


@pytest.mark.parametrize("usual_axes", [True, False])
def test_the_strides_tell_which_edge_is_ahead(usual_axes: bool) -> None:
    held = held_steps(np.zeros(40))
    for steps, ahead_deg in ((held, 90.0), ([turned_samples(one) for one in held], 0.0)):
        pointing = final_pointings(steps, usual_axes)[-1]
        assert pointing is not None
        assert pointing.decided
        assert np.rad2deg(pointing.azimuth(steps[-1])) == pytest.approx(ahead_deg, abs=1.0)


@pytest.mark.parametrize("usual_axes", [True, False])
def test_without_strides_that_tell_it_only_the_usual_axes_decide_the_direction(usual_axes: bool) -> None:
    still = [replace(one, frequency_hz=0.0) for one in held_steps(np.zeros(40))]
    pointing = final_pointings(still, usual_axes)[-1]
    assert pointing is not None
    assert pointing.decided == usual_axes


def priors_of(steps: list[Step]) -> tuple[list[HeadingPrior], NorthPriors]:
    stage = NorthPriors("phone", DEVICE, PARAMETERS, DRIFT)
    return run(stage, steps), stage


def test_a_phone_out_of_the_hand_tells_nothing() -> None:
    for mode in (CarryingMode.POCKET, CarryingMode.SWING, CarryingMode.OTHER, CarryingMode.UNKNOWN):
        assert priors_of(held_steps(np.zeros(40), mode))[0] == []
    assert priors_of(held_steps(np.zeros(40)))[0]


def test_a_few_mistaken_steps_tell_nothing_and_doubtful_ones_little() -> None:
    held = held_steps(np.zeros(20))
    swung = held_steps(np.zeros(20), CarryingMode.SWING)
    assert priors_of([*swung[:10], *held[10:12], *swung[12:15], *held[15:17], *swung[17:]])[0] == []
    doubtful = [replace(one, event=replace(one.event, mode_probability=0.9)) for one in held]
    (sure, *_), (unsure, *_) = priors_of(held)[0], priors_of(doubtful)[0]
    assert sure.time_s == unsure.time_s == held[0].event.time_s
    assert unsure.sigma_rad > 1.5 * sure.sigma_rad


def test_a_disturbed_stretch_is_found_and_weighs_less() -> None:
    calm = np.zeros(120)
    disturbed = calm.copy()
    disturbed[60:80] = 100.0
    priors, stage = priors_of(held_steps(disturbed))
    expected, quiet = priors_of(held_steps(calm))
    assert quiet.findings == ()
    (found,) = stage.findings
    assert found.kind is FindingKind.NORTH
    assert found.device == "phone"
    assert found.begin_s == pytest.approx(30.0, abs=4.0)
    assert found.end_s == pytest.approx(40.0, abs=4.0)
    assert found.value == pytest.approx(np.deg2rad(100.0), abs=0.4)  # of which some is taken for usual
    assert "disagrees with the gyroscope by up to" in found.message
    hit = [one for one in priors if 34.0 < one.time_s < 40.0]
    usual = {one.time_s: one.sigma_rad for one in expected}
    assert hit
    assert all(one.sigma_rad > usual[one.time_s] for one in hit)


@pytest.mark.slow
def test_all_priors_together_know_no_more_than_the_part_that_stays_allows() -> None:
    stage = NorthPriors("phone", DEVICE, PARAMETERS, 1e-6)  # a perfect gyroscope
    priors = run(stage, held_steps(np.zeros(3000)))
    information = sum(1.0 / prior.sigma_rad**2 for prior in priors)
    assert information < 1.0 / PARAMETERS.sigma_hold_rad**2
    assert information > 0.7 / PARAMETERS.sigma_hold_rad**2


def test_independent_sigmas_give_the_variance_of_the_correlated_errors() -> None:
    stays, wanders, white, length_m = 0.1, 0.3, 0.05, 6.0
    place_m = np.array([0.0, 2.0, 7.0, 8.0, 30.0])
    error = CorrelatedHeadingError(stays, wanders, length_m)
    information = 0.0
    for number, moved_m in enumerate(np.diff(place_m, prepend=0.0)):
        error.move(0.0, 0.0, moved_m)
        expected_rad = error.expected_sigma(white)
        measured = error.measure(0.2, white)
        assert measured.sigma_rad == pytest.approx(expected_rad)
        information += 1.0 / measured.sigma_rad**2
        known = place_m[: number + 1]
        apart_m = np.abs(known[:, None] - known[None, :])
        covariance = stays**2 + wanders**2 * np.exp(-apart_m / length_m) + white**2 * np.eye(len(known))
        ones = np.ones(len(known))
        assert information == pytest.approx(ones @ np.linalg.solve(covariance, ones), rel=1e-3)


def test_a_lost_heading_is_found_again_with_the_first_prior_after_the_gap() -> None:
    steps = held_steps(np.zeros(60))
    later = [replace(one, event=replace(one.event, segment=1)) for one in steps[30:]]
    priors, _ = priors_of([*steps[:30], *later])
    after = next(one for one in priors if one.time_s > 15.0)
    assert after.time_s == later[0].event.time_s
    assert after.sigma_rad < 1.3 * priors[0].sigma_rad


def test_how_the_walk_is_cut_changes_nothing() -> None:
    steps = held_steps(np.concatenate([np.zeros(30), np.full(10, 80.0), np.linspace(0.0, 40.0, 40)]))
    check_stage(lambda: NorthPriors("phone", DEVICE, PARAMETERS, DRIFT), steps)
    check_partition(lambda: NorthPriors("phone", DEVICE, PARAMETERS, DRIFT), steps, compare=lambda one: one.findings)


def test_all_but_the_absolute_priors_is_the_same_without_north() -> None:
    walk = corner_walk(sensors=SensorParams(magnetometer=NO_SENSOR_ERRORS))
    (plain,) = analyse_recording(walk.recording, Config().replace({"heading.north.source": "none"}))
    (found,) = analyse_recording(walk.recording, Config())
    assert found.knows_north()
    assert not plain.knows_north()
    rest = [one for one in found.odometry if not isinstance(one, HeadingPrior) or one.relative]
    assert repr(rest) == repr(list(plain.odometry))
