"""Learning a walker's own step length from walks with position fixes, or of known length."""

import hashlib
import warnings
from collections.abc import Sequence

import numpy as np

from pdr_est.calibration.profile import LearntWalk, Profile, check_model_matches, new_profile
from pdr_est.calibration.scale_by_distance import observe_known_distance
from pdr_est.calibration.scale_by_fixes import observe_any_fixes, without_personal_constants
from pdr_est.calibration.step_length_fit import NotLearnt, ScaleObservation
from pdr_est.config import Config
from pdr_est.pipeline import analyse_recording
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Recording


def learn(
    recording: Recording,
    profile: Profile | None = None,
    fixes: Sequence[PositionFix] = (),
    *,
    distance_m: float | None = None,
    config: Config | None = None,
) -> Profile:
    """Learn a walker's step length from a recorded walk.

    The walk teaches what its fixes or its length tell beyond what is expected of people; without either the profile
    stays as it is. A walk that the profile knows already, from one device or several, is learnt anew in place of the
    earlier time. From fixes that disagree with the steps or with each other nothing is learnt, and a warning says so.

    Parameters
    ----------
    recording
        The walk, of one or several devices.
    profile
        What is known of the walker; a new profile if omitted.
    fixes
        Known positions in the map frame.
    distance_m
        True length of the whole way, m; then the fixes are not used.
    config
        Settings; the defaults if omitted. Constants of the walker in it are left out.

    Returns
    -------
    Profile
        The profile with this walk. `pdr_est.apply_profile` gives the settings for other walks of the same person, and
        `pdr_est.save_profile` keeps it.

    Raises
    ------
    ConfigError
        If the profile was made with other settings, or the estimator does not use fixes.
    RecordingError
        If the walk has no steps, or a step length that nobody has. Errors of `pdr_est.smooth` are passed on.
    """
    plain = without_personal_constants(Config() if config is None else config)
    known = new_profile(plain) if profile is None else profile
    check_model_matches(plain, known, "profile")
    walk = learnt_walk(recording, analyse_recording(recording, plain), plain, fixes, distance_m)
    if isinstance(walk, LearntWalk):
        return known.with_walk(walk)
    if walk.doubtful:
        warnings.warn(f"{recording.name}: nothing learnt: {walk.reason}", stacklevel=2)
    return known


def learnt_walk(
    recording: Recording,
    devices: Sequence[DeviceWalk],
    config: Config,
    fixes: Sequence[PositionFix] = (),
    distance_m: float | None = None,
) -> LearntWalk | NotLearnt:
    """Find what a walk shows of its walker, or why that is nothing.

    Parameters
    ----------
    recording
        The walk.
    devices
        Result of the front end, without personal constants.
    config
        Settings of the estimator, without personal constants.
    fixes
        Known positions; not used with a distance.
    distance_m
        True length of the whole way, m.
    """
    if distance_m is not None:
        seen = observe_known_distance(devices, distance_m, recording.name)
    else:
        seen = observe_any_fixes(devices, config, fixes, recording.name)
    return seen if isinstance(seen, NotLearnt) else walk_record(recording, seen, distance_m)


def walk_record(recording: Recording, seen: ScaleObservation, distance_m: float | None = None) -> LearntWalk:
    """Make the record of a walk for a profile from what it shows, and its true length if that was given, m."""
    parts = device_digests(recording)
    return LearntWalk(
        sha256=recording_digest(recording),
        name=recording.name,
        log_ratio=seen.log_ratio,
        sigma=seen.sigma,
        log_cadence=seen.log_cadence,
        distance_m=distance_m,
        devices=parts if len(parts) > 1 else (),
    )


def recording_digest(recording: Recording) -> str:
    """Compute the SHA-256 of the samples of all devices, whatever the names of files and devices and their order."""
    return _digest_of([_samples_digest(device) for device in recording.devices])


def device_digests(recording: Recording) -> tuple[str, ...]:
    """Compute the checksum of each device as that of a recording of this device alone, in order."""
    return tuple(sorted({_digest_of([_samples_digest(device)]) for device in recording.devices}))


def _samples_digest(device: DeviceRecording) -> str:
    """Compute the checksum of a device over a fixed list of signals.

    A signal that is added to the list changes the checksums of walks that a profile knows, which would then be learnt
    twice.
    """
    digest = hashlib.sha256()
    signals = (
        device.magnetic_field,
        device.attitude,
        device.specific_force,
        device.rotation_rate,
        device.linear_acceleration,
    )
    for signal in signals:
        if signal is None:
            continue
        for numbers in (signal.time_s, signal.values):
            digest.update(np.ascontiguousarray(numbers, dtype="<f8").tobytes())
    return digest.hexdigest()


def _digest_of(devices: Sequence[str]) -> str:
    return hashlib.sha256("".join(sorted(devices)).encode()).hexdigest()
