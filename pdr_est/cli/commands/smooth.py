"""`pdr-est smooth`: a recording becomes a folder with its track."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from pdr_est import pipeline
from pdr_est.calibration.profile import Profile, load_profile
from pdr_est.cli.clock_options import apply_clock_messages, apply_clock_options, clock_options
from pdr_est.cli.error_context import prefix_errors
from pdr_est.cli.fix_options import load_fixes
from pdr_est.cli.options import PATH, config_option, estimation_options, resolve_config
from pdr_est.cli.progress import ProgressBar, progress_bar
from pdr_est.clock_sync import ClockMethod
from pdr_est.config import Config
from pdr_est.io import read
from pdr_est.io.writers.atomic_output import staged_folder
from pdr_est.io.writers.checksums import file_digests
from pdr_est.preprocessing.merge import merge_recordings


@click.command("smooth")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING…")
@click.option("-o", "--output", type=PATH, required=True, metavar="OUT", help="Folder for the results.")
@click.option(
    "--fixes", metavar="FILE.csv|recording", help="Known positions: a table, or those in the recording itself."
)
@click.option("--profile", type=PATH, metavar="FILE.yaml", help="Profile of the walker, made by `pdr-est calibrate`.")
@config_option
@estimation_options
@clock_options
@click.option("--overwrite", is_flag=True, help="Replace the results of an earlier run in OUT.")
@click.option("-q", "--quiet", is_flag=True, help="Show no progress bar and no summary; warnings are still shown.")
def smooth_command(
    recordings: tuple[Path, ...],
    output: Path,
    fixes: str | None,
    profile: Path | None,
    clock: ClockMethod | None,
    clock_offsets: tuple[tuple[str, float], ...],
    messages: Path | None,
    overwrite: bool,
    quiet: bool,
    **settings: Any,
) -> None:
    """Turn RECORDING (a file, a folder or a zip) into a track with uncertainty, its files and its report.

    Give several recordings for devices that one person carried at the same time.
    """
    walker = None if profile is None else load_profile(profile)
    config = apply_clock_options(resolve_config(**settings, profile=walker), clock, clock_offsets, messages)
    with progress_bar("reading", total=4, quiet=quiet) as bar, staged_folder(output, overwrite) as folder:
        summary = smooth_into(folder, recordings, fixes, config, bar, walker, messages)
    for warning in summary["warnings"]:
        click.echo(f"warning: {warning}", err=True)
    if not quiet:
        click.echo(f"{summary['distance_m']:.1f} m in {summary['steps']} steps -> {output / 'report.html'}")


def smooth_into(
    folder: Path,
    paths: Sequence[Path],
    fixes: str | None,
    config: Config,
    bar: ProgressBar,
    profile: Profile | None = None,
    messages: Path | None = None,
) -> dict[str, Any]:
    """Read, smooth and write the recordings of one walk.

    Parameters
    ----------
    folder : Path
        Existing folder for the results.
    paths : sequence of Path
        Recordings of the walk.
    fixes : str or None
        Value of the option `--fixes`.
    config : Config
        Configuration.
    bar : ProgressBar
        Progress bar.
    profile : Profile or None
        Profile that the configuration was made with.
    messages : Path or None
        Table of messages by which the devices compared their clocks.

    Returns
    -------
    dict
        The summary.
    """
    from pdr_est.report.walk.result_files import write_results  # matplotlib is slow to load

    recorded = apply_clock_messages(merge_recordings([read(path) for path in paths]), messages)
    known = load_fixes(fixes, recorded, paths[0])
    bar.start_part("smoothing")
    with prefix_errors(", ".join(map(str, paths))):
        walk = pipeline.smooth_recording(recorded, config, known)
    bar.start_part("writing")
    digests = {name: digest for path in paths for name, digest in _digests(path, len(paths) > 1).items()}
    return write_results(folder, walk, recorded, config, digests, profile)


def _digests(path: Path, several: bool) -> dict[str, str]:
    """Compute checksums by file; of several recordings by their paths, since files of one app have the same names."""
    digests = file_digests(path)
    if not several:
        return digests
    return {str(path) if path.is_file() else str(path / name): digest for name, digest in digests.items()}
