"""Apply the options about the clocks of several devices to configuration and recording."""

from dataclasses import replace
from pathlib import Path

from pdr_est.clock_sync import ClockMethod
from pdr_est.config import Config, config_from_dict, config_to_dict
from pdr_est.errors import ConfigError
from pdr_est.io.side_tables.clock_messages import read_clock_messages
from pdr_est.types.recording import Recording


def apply_clock_options(
    config: Config, clock: ClockMethod | None, offsets: tuple[tuple[str, float], ...], messages: Path | None
) -> Config:
    """Apply the clock options to the configuration.

    Raises
    ------
    ConfigError
        For options that contradict each other.
    """
    if messages is not None and offsets:
        raise ConfigError("--messages and --clock-offset both set the clocks: give one of them")
    wanted: ClockMethod | None = "messages" if messages is not None else "given" if offsets else clock
    option = "--messages" if messages is not None else "--clock-offset" if offsets else "--clock"
    if clock is not None and clock != wanted:
        raise ConfigError(f"--clock {clock}: does not use {option}: give --clock {wanted}, or leave {option} out")
    if wanted is None:
        return config
    settings = config_to_dict(config)
    settings["devices"]["clock"] = wanted
    if offsets:
        settings["devices"]["clocks"] = [{"device": name, "offset_s": offset_s} for name, offset_s in offsets]
    elif wanted != "given":
        settings["devices"]["clocks"] = []  # those of the file are overruled with the method
    return config_from_dict(settings, option)


def apply_clock_messages(recording: Recording, messages: Path | None) -> Recording:
    """Replace the clock messages of the recording by those of a table, if one is given."""
    return recording if messages is None else replace(recording, messages=(read_clock_messages(messages),))
