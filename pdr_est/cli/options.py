"""Options that several commands share, and their effect on the configuration."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click
import numpy as np

from pdr_est.calibration.profile import Profile, apply_profile, check_profile_matches
from pdr_est.config import Config, config_with, load_config
from pdr_est.estimators import ESTIMATORS
from pdr_est.front_end.heading import HEADINGS
from pdr_est.front_end.step_length import LENGTH_MODELS
from pdr_est.front_end.steps import DETECTORS
from pdr_est.io.tables.mapping_file import load_mapping

Command = TypeVar("Command", bound=Callable[..., Any])

PATH = click.Path(path_type=Path)


class _Degrees(click.FloatRange):
    """Direction in degrees; unlike click's own range it refuses "nan"."""

    def __init__(self) -> None:
        super().__init__(-360.0, 360.0)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        direction_deg = super().convert(value, param, ctx)
        if np.isnan(direction_deg):
            self.fail(f"{value} is not a direction: give degrees from -360 to 360", param, ctx)
        return direction_deg


DEGREES = _Degrees()


def config_option(command: Command) -> Command:
    """Add the option --config FILE.yaml to a command."""
    option = click.option(
        "--config", "config_file", type=PATH, metavar="FILE.yaml", help="Settings that differ from the defaults."
    )
    return option(command)


def map_option(command: Command) -> Command:
    """Add the option --map FILE.yaml to a command, which then takes a `mapping`."""
    option = click.option(
        "--map",
        "mapping",
        type=PATH,
        metavar="FILE.yaml",
        callback=lambda context, parameter, path: None if path is None else load_mapping(path),
        help="What the columns of a table mean; `pdr-est inspect --write-map` writes a draft.",
    )
    return option(command)


def overwrite_option(command: Command) -> Command:
    """Add the option --overwrite to a command."""
    option = click.option("--overwrite", is_flag=True, help="Replace the output FILE if it exists.")
    return option(command)


def given_paths(*paths: Path | None) -> list[Path]:
    """Select those of some optional paths that were given."""
    return [path for path in paths if path is not None]


def detector_option(command: Command) -> Command:
    """Add the option --detector NAME to a command."""
    option = click.option("--detector", type=click.Choice(DETECTORS), help="Step detector. Default: auto.")
    return option(command)


def length_model_option(command: Command) -> Command:
    """Add the option --length-model NAME to a command."""
    text = "Model of the step length. Default: auto."
    option = click.option("--length-model", type=click.Choice(LENGTH_MODELS), help=text)
    return option(command)


def height_and_gender_options(command: Command) -> Command:
    """Add the options --height M and --gender NAME to a command."""
    gender = click.option(
        "--gender",
        type=click.Choice(("male", "female"), case_sensitive=False),
        help="Gender of the walker, for the step-length models static and mmpdr.",
    )
    height = click.option(
        "--height",
        "height_m",
        type=float,
        metavar="M",
        help="Height of the walker in metres, for the step-length models auto, static and mmpdr.",
    )
    return height(gender(command))


def estimation_options(command: Command) -> Command:
    """Add the options about walker, start, estimator, detector, length model, headings and attitude to a command."""
    for option in reversed(
        (
            click.option(
                "--estimator", type=click.Choice(ESTIMATORS), help="Estimator of the track. Default: factor-graph."
            ),
            detector_option,
            length_model_option,
            height_and_gender_options,
            click.option(
                "--start", type=(float, float), metavar="X Y", help="Start position in the map frame, metres."
            ),
            click.option(
                "--heading",
                "heading_deg",
                type=DEGREES,
                metavar="DEG",
                help="Heading at the start, degrees counter-clockwise from east (the x axis).",
            ),
            click.option("--closed", is_flag=True, default=None, help="Assume that the walk ends where it began."),
            click.option(
                "--corridors",
                "corridors_deg",
                type=DEGREES,
                metavar="DEG",
                help="Direction of the building's corridors, which cross at right angles; degrees as for --heading.",
            ),
            click.option(
                "--heading-method", type=click.Choice(HEADINGS), help="Method of finding headings. Default: auto."
            ),
            click.option(
                "--attitude",
                type=click.Choice(("auto", "vqf", "device")),
                help="Attitude from the samples (vqf), the device's own, or that if samples are coarse (auto).",
            ),
        )
    ):
        command = option(command)
    return command


def resolve_config(
    config_file: Path | None,
    *,
    estimator: str | None = None,
    detector: str | None = None,
    length_model: str | None = None,
    height_m: float | None = None,
    gender: str | None = None,
    start: tuple[float, float] | None = None,
    heading_deg: float | None = None,
    closed: bool | None = None,
    corridors_deg: float | None = None,
    heading_method: str | None = None,
    attitude: str | None = None,
    profile: Profile | None = None,
) -> Config:
    """Build the configuration of a command: defaults, then the walker's profile, then the file, then the options.

    Raises
    ------
    ConfigError
        If a value is wrong or contradicts the profile; the message names the file or the option.
    """
    config = Config() if profile is None else apply_profile(Config(), profile)
    if config_file is not None:
        config = load_config(config_file, base=config)
    x_m, y_m = (None, None) if start is None else start
    heading_rad = None if heading_deg is None else float(np.deg2rad(heading_deg))
    corridors = None if corridors_deg is None else {"direction_rad": float(np.deg2rad(corridors_deg))}
    for option, section, values in (
        ("--estimator", "estimator", {"name": estimator}),
        ("--detector", "steps", {"detector": detector}),
        ("--length-model", "step_length", {"model": length_model}),
        ("--height", "walker", {"height_m": height_m}),
        ("--gender", "walker", {"gender": gender}),
        ("--start", "start", {"x_m": x_m, "y_m": y_m}),
        ("--heading", "start", {"heading_rad": heading_rad}),
        ("--closed", "start", {"closed": closed}),
        ("--corridors", "heading", {"dominant": corridors}),
        ("--heading-method", "heading", {"method": heading_method}),
        ("--attitude", "attitude", {"source": attitude}),
    ):
        given = {key: value for key, value in values.items() if value is not None}
        if given:
            config = config_with(config, {section: given}, option)
    if profile is not None:
        check_profile_matches(config, profile, "--profile")
    return config
