"""The contract of an estimator, offline and online, on walks whose answer is known.

`docs/writing-an-estimator.md` explains the contract.
"""

import pickle
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pdr_est.estimators import BuiltInEstimator, EstimatorSpec, OnlinePose
from pdr_est.frames import wrap_angle
from pdr_est.testing.partitions import exact_content
from pdr_est.types.measurements import (
    DeviceMeasurements,
    DeviceTether,
    LoopClosure,
    PositionFix,
    StartPose,
    StepOdometry,
)
from pdr_est.types.region import PoseRegion
from pdr_est.types.track import Track

_STEPS, _STEP_S, _STEP_M = 40, 0.5, 0.7
_START = StartPose((3.0, -2.0), 0.3, 0.2, 0.05)
_SIGMA_SCALE = 0.1
_SAMPLING = 0.3  # of its own standard deviation, by which an estimator that samples may miss a mean
_COVARIANCE = np.diag([0.07, 0.09, 0.03]) ** 2


def check_estimator(estimator: Any) -> None:
    """Check what every estimator promises.

    It has `spec` and `estimate`; its track has a pose for the start and for the end of each step of each device, with
    finite values and true covariances, and says which estimator made it; the same measurements give the same track;
    arguments are not changed; another start moves the track with it; fixes, a closed walk and tethers have the effect
    that the spec states. If the spec says `online`, the filter that `begin` makes gives a pose for each step.

    Parameters
    ----------
    estimator
        The estimator, not a class.

    Raises
    ------
    AssertionError
        With what is wrong.
    """
    for attribute in ("spec", "estimate"):
        assert hasattr(estimator, attribute), f"{type(estimator).__name__} has no {attribute}"
    spec = estimator.spec
    assert isinstance(spec, EstimatorSpec), (
        f"{type(estimator).__name__}.spec is {spec!r}: it must be an EstimatorSpec"
    )
    _check_track(estimator)
    _check_purity(estimator)
    _check_start(estimator)
    _check_walk_without_steps(estimator)
    _check_several_devices(estimator)
    _check_fixes(estimator)
    if spec.uses_closure:
        _check_closure(estimator)
    if spec.uses_tethers:
        _check_tethers(estimator)
    if spec.online and (not isinstance(estimator, BuiltInEstimator) or estimator.has_filter):
        _check_online(estimator)


def _steps(device: str = "phone", drift_rad: float = 0.0) -> tuple[StepOdometry, ...]:
    """Make forty steps with a quarter turn to the left in the middle."""
    turns = [drift_rad + (np.pi / 2.0 if k == _STEPS // 2 else 0.0) for k in range(_STEPS)]
    return tuple(
        StepOdometry(device, _STEP_S * (k + 1), _STEP_S * k, _STEP_M, turn, _COVARIANCE.copy())
        for k, turn in enumerate(turns)
    )


def _walk(*further: Any, device: str = "phone", drift_rad: float = 0.0) -> DeviceMeasurements:
    return DeviceMeasurements(device, 0.0, (*_steps(device, drift_rad), *further))


def _run(
    estimator: Any,
    devices: Sequence[DeviceMeasurements],
    tethers: Sequence[DeviceTether] = (),
    start: StartPose = _START,
) -> Track:
    track = estimator.estimate(devices, tethers, start, _SIGMA_SCALE)
    assert isinstance(track, Track), f"{_name(estimator)} returns {type(track).__name__}: it must return a Track"
    return track


def _name(estimator: Any) -> str:
    return f"estimator {estimator.spec.name}"


def _check_track(estimator: Any) -> None:
    track, name = _run(estimator, [_walk()]), _name(estimator)
    assert track.devices == ("phone",), f"{name}: the track is of {track.devices}, the measurements of ('phone',)"
    assert len(track) == _STEPS + 1, f"{name}: {len(track)} poses for the start and {_STEPS} steps"
    times_s = np.array([0.0, *(step.time_s for step in _steps())])
    assert np.allclose(track.time_s, times_s), f"{name}: the poses are not at the start and the ends of the steps"
    kinds = ("smoothed",) if estimator.spec.smooths else ("filtered", "delayed")
    assert track.kind in kinds, f"{name}: the track is {track.kind!r}, by the spec it must be {' or '.join(kinds)}"
    assert track.estimator == estimator.spec.name, f"{name}: the track names the estimator {track.estimator!r}"
    for column in ("position_m", "heading_rad", "covariance_m2", "sigma_heading_rad", "step_length_m"):
        assert np.isfinite(getattr(track, column)).all(), f"{name}: {column} has values that are not finite"
    _check_covariances(track, name)
    expected = [np.array(_START.position_m)]
    heading = 0.3
    for step in _steps():
        heading += step.heading_change_rad
        expected.append(expected[-1] + step.length_m * np.array([np.cos(heading), np.sin(heading)]))
    spread = np.trace(track.covariance_m2, axis1=1, axis2=2)
    allowed_m = 1e-3 + (_SAMPLING * np.sqrt(spread) if estimator.spec.sampled else 0.0)
    beyond_m = np.linalg.norm(track.position_m - np.array(expected), axis=1) - allowed_m
    off_m = float(np.linalg.norm(track.position_m - np.array(expected), axis=1).max())
    assert beyond_m.max() <= 0.0, f"{name}: without fixes the track is {off_m:.3f} m off that of the steps"
    assert spread[-1] > spread[0], f"{name}: without fixes the uncertainty does not grow"


def _check_covariances(track: Track, name: str) -> None:
    covariance = track.covariance_m2
    assert np.allclose(covariance, covariance.transpose(0, 2, 1)), f"{name}: a covariance is not symmetric"
    least = np.linalg.eigvalsh(covariance)[:, 0]
    assert (least >= -1e-12).all(), f"{name}: a covariance has the eigenvalue {least.min():.3g}, below 0"
    assert (track.sigma_heading_rad >= 0.0).all(), f"{name}: a sigma_heading_rad is below 0"
    if track.region is not None:
        _check_region(track.region, len(track), name)


def _check_region(region: PoseRegion, poses: int, name: str) -> None:
    used = region.weight > 0.0
    assert len(region) == poses, f"{name}: the region has {len(region)} poses, the track {poses}"
    assert np.allclose(region.weight.sum(axis=1), 1.0), f"{name}: weights of a region do not add up to 1"
    least = np.linalg.eigvalsh(region.covariance_m2[used])[:, 0]
    assert np.isfinite(region.mean_m[used]).all(), f"{name}: a component of a region has no finite mean"
    assert (least >= -1e-12).all(), f"{name}: a covariance of a region has the eigenvalue {least.min():.3g}, below 0"


def _check_purity(estimator: Any) -> None:
    devices = [_walk(_fix(20.0))]
    before = exact_content(devices)
    first, second = _run(estimator, devices), _run(estimator, devices)
    assert exact_content(devices) == before, f"{_name(estimator)} changes its arguments: make new records"
    same = exact_content([first]) == exact_content([second])
    assert same, f"{_name(estimator)}: the same measurements give another track the second time"


def _check_start(estimator: Any) -> None:
    """Check that another start moves and turns the track as a whole."""
    track, moved = (
        _run(estimator, [_walk()]),
        _run(estimator, [_walk()], start=replace(_START, heading_rad=0.3 + 1.0)),
    )
    turn = np.array([[np.cos(1.0), -np.sin(1.0)], [np.sin(1.0), np.cos(1.0)]])
    origin = np.array(_START.position_m)
    expected = (track.position_m - origin) @ turn.T + origin
    assert np.allclose(moved.position_m, expected, atol=1e-3), (
        f"{_name(estimator)}: a turned start does not turn the track"
    )
    turned = np.abs(wrap_angle(moved.heading_rad - track.heading_rad - 1.0)).max()
    assert turned < 1e-3, f"{_name(estimator)}: a turned start does not turn the headings"


def _check_walk_without_steps(estimator: Any) -> None:
    track = _run(estimator, [DeviceMeasurements("phone", 0.0, ())])
    assert len(track) == 1, f"{_name(estimator)}: a walk without steps has {len(track)} poses: it must have its start"
    off_m = float(np.linalg.norm(track.position_m[0] - np.array(_START.position_m)))
    allowed_m = _SAMPLING * _START.sigma_position_m if estimator.spec.sampled else 1e-6
    assert off_m < allowed_m, f"{_name(estimator)}: a walk without steps is {off_m:.3g} m off its start"


def _check_several_devices(estimator: Any) -> None:
    track = _run(estimator, [_walk(device="left"), _walk(device="right")])
    assert track.devices == ("left", "right"), f"{_name(estimator)}: tracks of {track.devices} for left and right"
    assert len(track) == 2 * (_STEPS + 1), f"{_name(estimator)}: {len(track)} poses for two devices"


def _fix(time_s: float, sigma_m: float = 0.1) -> PositionFix:
    """Make a fix three metres beside the way of the steps."""
    heading = 0.3 if time_s <= _STEP_S * _STEPS / 2 else 0.3 + np.pi / 2.0
    position = np.array(_START.position_m) + _STEP_M * _STEPS / 2 * np.array([np.cos(0.3), np.sin(0.3)])
    position = position + 3.0 * np.array([-np.sin(heading), np.cos(heading)])
    if time_s > _STEP_S * _STEPS / 2:
        position = position + _STEP_M * _STEPS / 2 * np.array([np.cos(heading), np.sin(heading)])
    return PositionFix(time_s, position, sigma_m**2 * np.eye(2))


def _check_fixes(estimator: Any) -> None:
    fix = _fix(_STEP_S * _STEPS)
    with_fix, without = _run(estimator, [_walk(fix)]), _run(estimator, [_walk()])
    moved_m = float(np.linalg.norm(with_fix.position_m[-1] - without.position_m[-1]))
    if not estimator.spec.uses_fixes:
        words = f"uses no fixes by its spec, but a fix moves the end of a walk from a known start by {moved_m:.2f} m"
        assert moved_m < 1e-6, f"{_name(estimator)} {words}"
        return
    left_m = float(np.linalg.norm(with_fix.position_m[-1] - fix.position_m))
    assert left_m < 0.6, f"{_name(estimator)} uses fixes by its spec, but ends {left_m:.2f} m from one of 0.1 m"
    spread, wide = (float(np.trace(track.covariance_m2[-1])) for track in (with_fix, without))
    assert spread < wide, f"{_name(estimator)}: a fix at the end of a walk does not make the end more certain"


def _check_closure(estimator: Any) -> None:
    closed, open_ = _run(estimator, [_walk(LoopClosure("phone", 0.1))]), _run(estimator, [_walk()])
    ends_m = [float(np.linalg.norm(track.position_m[-1] - track.position_m[0])) for track in (closed, open_)]
    words = f"the closed walk ends {ends_m[0]:.2f} m from its start, the open one {ends_m[1]:.2f} m"
    assert ends_m[0] < 0.5 * ends_m[1], f"{_name(estimator)} uses loop closures by its spec, but {words}"


def _check_tethers(estimator: Any) -> None:
    devices = [_walk(device="left", drift_rad=0.01), _walk(device="right", drift_rad=-0.01)]
    tethers = [DeviceTether("left", "right", float(time_s), 0.5, 0.02) for time_s in range(1, _STEPS // 2 + 1)]
    apart_m = []
    for given in ((), tethers):
        track = _run(estimator, devices, given)
        ends = [track.of_device(name).position_m[-1] for name in ("left", "right")]
        apart_m.append(float(np.linalg.norm(ends[0] - ends[1])))
    words = f"devices tethered to 0.5 m end {apart_m[1]:.2f} m apart, without tethers {apart_m[0]:.2f} m"
    assert apart_m[1] < 0.5 * apart_m[0], f"{_name(estimator)} uses tethers by its spec, but {words}"


def _check_online(estimator: Any) -> None:
    name = _name(estimator)
    assert hasattr(estimator, "begin"), f"{name} is online by its spec, but has no begin"
    own = estimator.begin(["phone"], _START, _SIGMA_SCALE)
    for attribute in ("push", "flush"):
        assert hasattr(own, attribute), f"{name}: the filter that begin makes has no {attribute}"
    poses: list[OnlinePose] = []
    for number, measurement in enumerate((*_steps(), _fix(_STEP_S * _STEPS))):
        if number == _STEPS // 2:
            own = pickle.loads(pickle.dumps(own))
        emitted = own.push(measurement)
        assert isinstance(emitted, list), f"{name}: push returns {type(emitted).__name__}: it must return a list"
        poses += emitted
    poses += own.flush()
    wrong = [pose for pose in poses if not isinstance(pose, OnlinePose)]
    assert not wrong, f"{name}: the filter gives {wrong[:1]}: it must give OnlinePose"
    latest = {pose.time_s: pose for pose in poses}
    missing = [step.time_s for step in _steps() if step.time_s not in latest]
    assert not missing, f"{name}: the filter gives no pose for the step that ends at {missing[:1]} s"
    end = latest[_STEP_S * _STEPS]
    assert end.covariance.shape == (3, 3), f"{name}: the covariance of a pose has the shape {end.covariance.shape}"
    assert np.linalg.eigvalsh(end.covariance)[0] >= -1e-12, f"{name}: a covariance has an eigenvalue below 0"
