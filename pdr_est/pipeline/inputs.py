"""Refuse inputs of the pipeline that cannot be used, before any work is done."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pdr_est.config import Config
from pdr_est.errors import ConfigError, RecordingError
from pdr_est.io.side_tables.position_fixes import require_fix_inside
from pdr_est.params.validation_messages import brief
from pdr_est.preprocessing.quality.requirements import require_track_sensors
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording


def refuse_no_config(config: Any) -> None:
    """Raise ConfigError for something that is no configuration, such as the path of one."""
    if not isinstance(config, Config):
        remedy = "load it with load_config" if isinstance(config, str | Path) else "give a Config"
        raise ConfigError(f"config = {brief(config)}: is no configuration: {remedy}")


def refuse_settings_for_whole_walks(config: Any) -> None:
    """Raise ConfigError for something that is no configuration, and for settings that need the whole walk."""
    refuse_no_config(config)
    if config.heading.dominant.direction_rad is not None:
        raise ConfigError(
            "heading.dominant.direction_rad: the directions of a building are found from the whole walk: leave "
            "it out for tracking, or use `pdr-est smooth`"
        )


def refuse_wrong_types(recording: Any, config: Any) -> None:
    """Raise RecordingError or ConfigError for something that is no recording or no configuration."""
    refuse_no_config(config)
    if not isinstance(recording, Recording):
        remedy = "read it first: pdr_est.read(path)" if isinstance(recording, str | Path) else "give a Recording"
        raise RecordingError(f"recording = {brief(recording)}: is no recording: {remedy}")


def refuse_unusable_inputs(recording: Recording, fixes: Any) -> None:
    """Raise RecordingError for a device without a sensor that a track needs, and for fixes that cannot be used.

    Fixes must be `PositionFix`, and within the time of the recording.
    """
    for device in recording.devices:
        require_track_sensors(device, recording.place_of(device), one_of_several=len(recording.devices) > 1)
    _refuse_unusable_fixes(fixes, recording)


def _refuse_unusable_fixes(fixes: Any, recording: Recording) -> None:
    """Check the fixes; the recorder's own may lie outside, for it may have received them before the first sample."""
    if not isinstance(fixes, Sequence) or isinstance(fixes, str):
        raise RecordingError(f"fixes = {brief(fixes)}: is no list: give a list of PositionFix")
    recorded = {id(fix) for fix in recording.fixes}
    for number, fix in enumerate(fixes):
        if not isinstance(fix, PositionFix):
            raise RecordingError(
                f"fixes[{number}] = {brief(fix)}: is no PositionFix: give PositionFix(time_s, position_m, "
                "covariance_m2)"
            )
        if id(fix) not in recorded:
            require_fix_inside(fix.time_s, f"fixes[{number}]", recording)
