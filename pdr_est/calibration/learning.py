"""Learning a walker's own step length from walks with position fixes, or of known length."""

import hashlib
from collections.abc import Sequence

import numpy as np

from pdr_est.calibration.profile import LearntWalk, Profile, check_model_matches, new_profile
from pdr_est.calibration.scale_by_fixes import observe_any_fixes, without_personal_constants
from pdr_est.calibration.step_length_fit import CalibrationSteps, ScaleObservation, observe_distance
from pdr_est.config import Config
from pdr_est.pipeline import analyse_recording
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording


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
    stays as it is. A walk that the profile knows already is learnt anew in place of the earlier time.

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
    return known if walk is None else known.with_walk(walk)


def learnt_walk(
    recording: Recording,
    devices: Sequence[DeviceWalk],
    config: Config,
    fixes: Sequence[PositionFix] = (),
    distance_m: float | None = None,
) -> LearntWalk | None:
    """Find what a walk shows of its walker; None if its fixes tell nothing of the step length.

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
        steps = [CalibrationSteps.from_steps(device.steps) for device in devices]
        seen = observe_distance(steps, distance_m, recording.name)
    else:
        told = observe_any_fixes(devices, config, fixes, recording.name)
        if told is None:
            return None
        seen = told
    return walk_record(recording, seen, distance_m)


def walk_record(recording: Recording, seen: ScaleObservation, distance_m: float | None = None) -> LearntWalk:
    """Make the record of a walk for a profile from what it shows, and its true length if that was given, m."""
    return LearntWalk(
        sha256=recording_digest(recording),
        name=recording.name,
        log_ratio=seen.log_ratio,
        sigma=seen.sigma,
        log_cadence=seen.log_cadence,
        distance_m=distance_m,
    )


def recording_digest(recording: Recording) -> str:
    """Compute the SHA-256 of the samples of all devices, whatever the names of files and devices and their order."""
    of_devices = []
    for device in recording.devices:
        digest = hashlib.sha256()
        for block in device.blocks():
            for numbers in (block.time_s, block.values):
                digest.update(np.ascontiguousarray(numbers, dtype="<f8").tobytes())
        of_devices.append(digest.hexdigest())
    return hashlib.sha256("".join(sorted(of_devices)).encode()).hexdigest()
