"""Work of `pdr-est calibrate`: a step length from walks of known length or with known positions."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from pdr_est import pipeline
from pdr_est.calibration.learning import walk_record
from pdr_est.calibration.profile import LearntWalk, Profile, new_profile
from pdr_est.calibration.profile_file import profile_to_yaml
from pdr_est.calibration.scale_by_distance import observe_known_distance
from pdr_est.calibration.scale_by_fixes import observe_fixes, without_personal_constants
from pdr_est.calibration.step_length_fit import NotLearnt
from pdr_est.cli.call_paths import input_paths
from pdr_est.cli.error_context import prefix_errors
from pdr_est.cli.fix_options import RECORDED, WAYPOINTS, load_fixes
from pdr_est.cli.profile_options import describe_profile
from pdr_est.cli.recording_part import RecordingPart
from pdr_est.cli.settings import resolve_config
from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.io.side_tables.position_fixes import fixes_within
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.output.atomic_output import staged_file
from pdr_est.preprocessing.moments import Moment


def fit_profile(
    recordings: tuple[Path, ...],
    distances_m: tuple[float, ...],
    fixes: tuple[str, ...],
    begin: Moment | None,
    end: Moment | None,
    devices: tuple[str, ...],
    mapping: TableMapping | None,
    output: Path,
    overwrite: bool,
    config_file: Path | None,
    **settings: Any,
) -> None:
    """Fit a person's step length to each recording and write the profile."""
    if bool(distances_m) == bool(fixes):
        raise click.UsageError("give either --distance or --fixes")
    _refuse_repetition(recordings)
    config = without_personal_constants(resolve_config(config_file, **settings))
    part = RecordingPart(begin, end, devices, mapping)
    with staged_file(output, overwrite, input_paths()) as file:
        if distances_m:
            _refuse_wrong_count("--distance", len(distances_m), len(recordings))
            seen = [_by_distance(*pair, config, part) for pair in zip(recordings, distances_m, strict=True)]
        else:
            choices = fixes * len(recordings) if fixes in ((RECORDED,), (WAYPOINTS,)) else fixes
            _refuse_wrong_count("--fixes", len(choices), len(recordings))
            seen = [_by_fixes(*pair, config, part) for pair in zip(recordings, choices, strict=True)]
        profile = _profile(config, recordings, seen)
        file.write_text(profile_to_yaml(profile), encoding="utf-8")
    click.echo(f"{describe_profile(profile)} -> {output}")


def _refuse_repetition(recordings: Sequence[Path]) -> None:
    """Raise UsageError if a walk is given twice: it would count twice and make the result overconfident."""
    for i, path in enumerate(recordings):
        if path.resolve() in {earlier.resolve() for earlier in recordings[:i]}:
            raise click.UsageError(f"{path}: the same RECORDING is given twice: give each walk once")


def _refuse_wrong_count(option: str, count: int, recordings: int) -> None:
    if count != recordings:
        raise click.UsageError(
            f"{option} is given {count} times for {recordings} recording(s): give it once for each"
        )


def _by_distance(path: Path, distance_m: float, config: Config, part: RecordingPart) -> LearntWalk:
    whole = part.read([path])
    with prefix_errors(path):
        walks = pipeline.analyse_recording(part.cut(whole), config)
    seen = observe_known_distance(walks, distance_m, str(path))
    if isinstance(seen, NotLearnt):
        raise RecordingError(f"{path}: {seen.reason}")
    return walk_record(whole, seen, distance_m)


def _by_fixes(path: Path, choice: str, config: Config, part: RecordingPart) -> LearntWalk:
    whole = part.read([path])
    fixes = load_fixes(choice, whole, path)
    with prefix_errors(path):
        recording = part.cut(whole)
        walks = pipeline.analyse_recording(recording, config)
        fixes = fixes if part.is_all else fixes_within(fixes, recording)
        # The place is named by `prefix_errors`, which knows the errors of the smoother as well. The checksum is that
        # of the whole recording, so that two parts of it do not count as two walks.
        return walk_record(whole, observe_fixes(walks, config, fixes, recording.name))


def _profile(config: Config, recordings: Sequence[Path], seen: Sequence[LearntWalk]) -> Profile:
    """Make the profile; raise UsageError for two files with the same samples."""
    profile = new_profile(config)
    for path, walk in zip(recordings, seen, strict=True):
        if profile.known(walk.checksums):
            raise click.UsageError(f"{path}: holds the same samples as a RECORDING before: give each walk once")
        profile = profile.with_walk(walk)
    return profile
