"""Options that several commands share.

Nothing that is slow to load is imported here, because a help text needs all of them; what a value needs is imported
when one is given.
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from pdr_est.cli.call_paths import FixesType, OutputPath, note_input
from pdr_est.cli.choices import (
    CLOCK_METHODS,
    DETECTORS,
    ESTIMATORS,
    HEADING_METHODS,
    LENGTH_MODELS,
    TRACK_FORMATS,
)
from pdr_est.errors import ConfigError

if TYPE_CHECKING:
    from pdr_est.io.tables.mapping import TableMapping

Command = TypeVar("Command", bound=Callable[..., Any])

PATH = click.Path(path_type=Path)
OUTPUT = OutputPath()
FIXES = FixesType()
FIXES_METAVAR = "FILE.csv|recording|waypoints"


class _Degrees(click.FloatRange):
    """Direction in degrees; unlike click's own range it refuses "nan"."""

    def __init__(self) -> None:
        super().__init__(-360.0, 360.0)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        direction_deg = super().convert(value, param, ctx)
        if math.isnan(direction_deg):
            self.fail(f"{value} is not a direction: give degrees from -360 to 360", param, ctx)
        return direction_deg


DEGREES = _Degrees()


def config_option(command: Command) -> Command:
    """Add the option --config FILE.yaml to a command."""
    option = click.option(
        "--config", "config_file", type=PATH, metavar="FILE.yaml", help="Settings that differ from the defaults."
    )
    return option(command)


def _load_mapping(ctx: click.Context, _param: click.Parameter, path: Path | None) -> "TableMapping | None":
    if path is None or ctx.resilient_parsing:  # the latter while a word is completed, which must be quick
        return None
    note_input(path, ctx)
    from pdr_est.io.tables.mapping_file import load_mapping

    return load_mapping(path)


def map_option(command: Command) -> Command:
    """Add the option --map FILE.yaml to a command, which then takes a `mapping`."""
    option = click.option(
        "--map",
        "mapping",
        type=PATH,
        metavar="FILE.yaml",
        callback=_load_mapping,
        help="What the columns of a table mean; `pdr-est inspect --write-map` writes a draft.",
    )
    return option(command)


def overwrite_option(command: Command) -> Command:
    """Add the option --overwrite to a command."""
    option = click.option("--overwrite", is_flag=True, help="Replace the output FILE if it exists.")
    return option(command)


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
                "--estimator",
                type=click.Choice(ESTIMATORS),
                help="Estimator of the track. Default: factor-graph; with --plan particle; while recording ekf.",
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
                "--heading-method",
                type=click.Choice(HEADING_METHODS),
                help="Method of finding headings. Default: auto.",
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


class _MomentType(click.ParamType[Any]):
    """Seconds from the start of the recording, or a clock time."""

    name = "T"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if ctx is not None and ctx.resilient_parsing:  # while a word is completed, which must be quick
            return value
        from pdr_est.preprocessing.moments import Moment, parse_moment

        if isinstance(value, Moment):
            return value
        try:
            return parse_moment(value)
        except ConfigError as error:
            self.fail(str(error), param, ctx)


def recording_options(command: Command) -> Command:
    """Add the options --from T, --to T, --device NAME and --map FILE.yaml; `RecordingPart` takes their values."""
    for option in (
        map_option,
        click.option(
            "--device",
            "devices",
            multiple=True,
            metavar="NAME",
            help="Use this device only; may be repeated. `inspect` names the devices.",
        ),
        click.option("--to", "end", type=_MomentType(), help="Leave out what comes after T, as for --from."),
        click.option(
            "--from",
            "begin",
            type=_MomentType(),
            help="Leave out what comes before T: seconds from the start, or a clock time (14:03:05).",
        ),
    ):
        command = option(command)
    return command


def clock_options(command: Command) -> Command:
    """Add the options --clock METHOD, --clock-offset DEVICE SECONDS and --messages FILE.csv to a command."""
    for option in (
        click.option(
            "--messages",
            type=PATH,
            metavar="FILE.csv",
            help="Table of messages by which the devices compared their clocks: device,t1_s,t2_s,t3_s.",
        ),
        click.option(
            "--clock-offset",
            "clock_offsets",
            type=(str, float),
            multiple=True,
            metavar="DEVICE SECONDS",
            help="Seconds by which a device's clock is ahead of the first one's; may be repeated.",
        ),
        click.option(
            "--clock",
            type=click.Choice(CLOCK_METHODS),
            help="Method that aligns the clocks of several devices. Default: walk.",
        ),
    ):
        command = option(command)
    return command


def fixes_option(command: Command) -> Command:
    """Add the option --fixes to a command."""
    option = click.option(
        "--fixes",
        type=FIXES,
        metavar=FIXES_METAVAR,
        help="Known positions: a table, the GPS positions in the recording, or the points that somebody marked on "
        "the device while passing them.",
    )
    return option(command)


class _FormatsType(click.ParamType[Any]):
    """Names of formats of a track, separated by commas."""

    name = "formats"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        names = [name.strip().lower() for name in value.split(",")]
        for name in names:
            if name not in TRACK_FORMATS:
                self.fail(f"{name!r} is no format of a track: give one of {', '.join(TRACK_FORMATS)}", param, ctx)
        return tuple(names)


def _join_formats(
    _ctx: click.Context, _param: click.Parameter, value: tuple[tuple[str, ...], ...]
) -> tuple[str, ...] | None:
    names = tuple(dict.fromkeys(name for names in value for name in names))
    return names or None


def formats_option(default: str) -> Callable[[Command], Command]:
    """Return a decorator that adds the option --format NAME to a command, which then takes `formats`.

    Parameters
    ----------
    default
        What is written without the option, in words.
    """
    return click.option(
        "--format",
        "formats",
        type=_FormatsType(),
        multiple=True,
        metavar="NAME,…",
        callback=_join_formats,
        help=f"Formats of the track for other programs: {', '.join(TRACK_FORMATS)}; may be repeated. {default}",
    )


def jobs_option(command: Command) -> Command:
    """Add the option --jobs N to a command."""
    option = click.option(
        "--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Processes for several walks."
    )
    return option(command)


def summary_option(command: Command) -> Command:
    """Add the option --summary FILE.csv to a command."""
    option = click.option(
        "--summary",
        type=OUTPUT,
        metavar="FILE.csv",
        help="Write a table with one row for each walk to this file.",
    )
    return option(command)
