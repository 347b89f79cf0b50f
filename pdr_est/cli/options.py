"""Options that several commands share, and what they do to the configuration."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click
import numpy as np

from pdr_est.config import Config, config_from_dict, config_to_dict, load_config
from pdr_est.estimators import ESTIMATORS

Command = TypeVar("Command", bound=Callable[..., Any])

EXISTING = click.Path(path_type=Path)


def config_option(command: Command) -> Command:
    """--config FILE.yaml"""
    option = click.option("--config", "config_file", type=EXISTING, help="Settings, where not the defaults (YAML).")
    return option(command)


def walker_options(command: Command) -> Command:
    """What is known of the walker, the start and the attitude."""
    for option in reversed(
        (
            click.option("--estimator", type=click.Choice(ESTIMATORS), help="Default: factor-graph."),
            click.option("--height", "height_m", type=float, help="Height of the walker in metres."),
            click.option("--gender", type=click.Choice(("male", "female")), help="Of the walker."),
            click.option("--start", type=(float, float), metavar="X Y", help="Start in the map frame, metres."),
            click.option(
                "--heading",
                "heading_deg",
                type=float,
                metavar="DEG",
                help="Start heading, degrees counter-clockwise from east (the x axis).",
            ),
            click.option(
                "--attitude",
                type=click.Choice(("vqf", "device")),
                help="Attitude from the raw samples (default) or the device's own.",
            ),
        )
    ):
        command = option(command)
    return command


def resolve_config(
    config_file: Path | None,
    estimator: str | None,
    height_m: float | None,
    gender: str | None,
    start: tuple[float, float] | None,
    heading_deg: float | None,
    attitude: str | None,
) -> Config:
    """The configuration of a command: defaults, then the file, then the options. Raises ConfigError."""
    config = Config() if config_file is None else load_config(config_file)
    settings = config_to_dict(config)
    heading = None if heading_deg is None else float(np.deg2rad(heading_deg))
    x, y = start if start is not None else (None, None)
    for section, key, value in (
        ("estimator", "name", estimator),
        ("walker", "height_m", height_m),
        ("walker", "gender", gender),
        ("start", "x_m", x),
        ("start", "y_m", y),
        ("start", "heading_rad", heading),
        ("attitude", "source", attitude),
    ):
        if value is not None:
            settings[section][key] = value
    return config_from_dict(settings, "command line")
