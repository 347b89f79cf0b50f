"""`pdr-est calibrate`: a person's own step length from walks of known length or with known positions."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import click

from pdr_est import pipeline
from pdr_est.calibration.profile import Profile, ProfileNote, profile_to_yaml
from pdr_est.calibration.step_length_fit import (
    Calibration,
    Observation,
    PacedSteps,
    fit,
    observe_distance,
    observe_fixes,
)
from pdr_est.cli.error_context import naming
from pdr_est.cli.fix_options import RECORDED, chosen_fixes
from pdr_est.cli.options import (
    PATH,
    body_options,
    config_option,
    given,
    length_model_option,
    overwrite_option,
    resolve_config,
)
from pdr_est.config import Config
from pdr_est.front_end.step_length import WalkerParams
from pdr_est.io import read
from pdr_est.io.writers.atomic_output import staged_file


@click.command()
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@click.option(
    "--distance",
    "distances_m",
    type=float,
    multiple=True,
    metavar="M",
    help="True length of the way in metres; once for each RECORDING, in their order.",
)
@click.option(
    "--fixes",
    multiple=True,
    metavar="FILE.csv|recording",
    help="Or known positions: once for each RECORDING, or once `recording` for all.",
)
@click.option("-o", "--output", type=PATH, required=True, metavar="FILE.yaml", help="The profile.")
@overwrite_option
@length_model_option
@body_options
@config_option
def calibrate(
    recordings: tuple[Path, ...],
    distances_m: tuple[float, ...],
    fixes: tuple[str, ...],
    output: Path,
    overwrite: bool,
    config_file: Path | None,
    **settings: Any,
) -> None:
    """Fit a person's own step length to each RECORDING, and write it as a profile for `smooth --profile`.

    A RECORDING should hold one walk of known length and no other steps. Several walks tell more than one; at
    different speeds they also tell how the steps change with the pace.
    """
    if bool(distances_m) == bool(fixes):
        raise click.UsageError("give either --distance or --fixes")
    _refuse_repetition(recordings)
    config = _impersonal(resolve_config(config_file, **settings))
    tables = [Path(choice) for choice in fixes if choice != RECORDED]
    with staged_file(output, overwrite, [*given(*recordings, config_file), *tables]) as file:
        if distances_m:
            _refuse_number("--distance", len(distances_m), len(recordings))
            seen = [_by_distance(*pair, config) for pair in zip(recordings, distances_m, strict=True)]
        else:
            choices = fixes * len(recordings) if fixes == (RECORDED,) else fixes
            _refuse_number("--fixes", len(choices), len(recordings))
            seen = [_by_fixes(*pair, config) for pair in zip(recordings, choices, strict=True)]
        found = fit(seen)
        file.write_text(profile_to_yaml(_profile(found, config, distances_m, len(recordings))), encoding="utf-8")
    click.echo(f"{_in_words(found, seen)} -> {output}")


def _impersonal(config: Config) -> Config:
    """Without the constants of an earlier calibration."""
    body = WalkerParams(height_m=config.walker.height_m, gender=config.walker.gender)
    return replace(config, walker=body)


def _refuse_repetition(recordings: Sequence[Path]) -> None:
    """A walk tells what it tells once; given again it would feign certainty."""
    for i, path in enumerate(recordings):
        if path.resolve() in {earlier.resolve() for earlier in recordings[:i]}:
            raise click.UsageError(f"{path}: the same RECORDING is given twice: give each walk once")


def _refuse_number(option: str, given: int, recordings: int) -> None:
    if given != recordings:
        raise click.UsageError(f"number of {option}: {given}, of recordings: {recordings}: give one for each")


def _by_distance(path: Path, distance_m: float, config: Config) -> Observation:
    recording = read(path)
    with naming(path):
        walks = pipeline.analyse(recording, config)
    return observe_distance([PacedSteps.of(walk.steps) for walk in walks], distance_m, str(path))


def _by_fixes(path: Path, choice: str, config: Config) -> Observation:
    recording = read(path)
    fixes = chosen_fixes(choice, recording, path)
    with naming(path):
        walks = pipeline.analyse(recording, config)
        # The place is named by `naming`, which knows the errors of the smoother as well.
        return observe_fixes(walks, config, fixes, recording.name)


def _profile(found: Calibration, config: Config, distances_m: Sequence[float], recordings: int) -> Profile:
    note = ProfileNote(
        step_length=config.step_length,
        detector=config.steps.detector,
        recordings=recordings,
        date=datetime.now(UTC).date(),
        distances_m=tuple(distances_m),
    )
    return Profile(note=note, walker=found.walker(config.walker), sigma_length_scale=found.sigma_next)


def _in_words(found: Calibration, seen: Sequence[Observation]) -> str:
    walker = found.walker(WalkerParams())
    words = f"length scale {walker.length_scale:.3f} from {len(seen)} walk{'s' if len(seen) > 1 else ''}"
    words += f" at {walker.reference_cadence_hz:.2f} steps/s, cadence exponent {walker.cadence_exponent:+.2f}"
    return f"{words}; the next walk's length is known to {100.0 * found.sigma_next:.1f} %"
