"""`pdr-est smooth`: a recording becomes a folder with its track."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from pdr_est import pipeline
from pdr_est.calibration.profile import LearntWalk, apply_profile
from pdr_est.calibration.step_length_fit import NotLearnt
from pdr_est.cli.clock_options import apply_clock_messages, apply_clock_options, clock_options
from pdr_est.cli.error_context import prefix_errors
from pdr_est.cli.fix_options import RECORDED, load_fixes
from pdr_est.cli.options import PATH, config_option, estimation_options, given_paths, resolve_config
from pdr_est.cli.profile_options import NO_PROFILE, WalkersProfile
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
@click.option(
    "--profile",
    type=PATH,
    metavar="FILE.yaml",
    help="Profile of the walker's own step length; with --learn it is made if there is none.",
)
@click.option("--learn", is_flag=True, help="Add to the profile what this walk tells of the step length.")
@click.option(
    "--distance", "distance_m", type=float, metavar="M", help="True length of the way in metres, for --learn."
)
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
    learn: bool,
    distance_m: float | None,
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
    own = WalkersProfile.of_options(profile, learn, distance_m)
    own.require_outside(output)
    config = apply_clock_options(resolve_config(**settings, profile=own.profile), clock, clock_offsets, messages)
    tables = [] if fixes in (None, RECORDED) else [Path(str(fixes))]
    inputs = given_paths(*recordings, settings["config_file"], messages, *tables)
    with (
        own.saved(config, inputs) as save,
        progress_bar("reading", total=4, quiet=quiet) as bar,
        staged_folder(output, overwrite) as folder,
    ):
        summary, walk = smooth_into(folder, recordings, fixes, config, bar, messages, own)
        words = save(walk)  # before the results appear, so that there are none if the profile refuses the walk
    doubt = [f"nothing learnt: {walk.reason}"] if isinstance(walk, NotLearnt) and walk.doubtful else []
    for warning in (*summary["warnings"], *doubt):
        click.echo(f"warning: {warning}", err=True)
    if not quiet:
        click.echo(f"{summary['distance_m']:.1f} m in {summary['steps']} steps -> {output / 'report.html'}")
        for line in words:
            click.echo(line)


def smooth_into(
    folder: Path,
    paths: Sequence[Path],
    fixes: str | None,
    config: Config,
    bar: ProgressBar,
    messages: Path | None = None,
    own: WalkersProfile = NO_PROFILE,
) -> tuple[dict[str, Any], LearntWalk | NotLearnt | None]:
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
        Configuration, with the constants of the profile.
    bar : ProgressBar
        Progress bar.
    messages : Path or None
        Table of messages by which the devices compared their clocks.
    own : WalkersProfile
        Profile of the walker, and whether it learns this walk.

    Returns
    -------
    summary : dict
        The summary.
    walk : LearntWalk, NotLearnt or None
        What a profile that learns gets from this walk; None if no profile learns.
    """
    from pdr_est.report.walk.result_files import write_results  # matplotlib is slow to load

    recorded = apply_clock_messages(merge_recordings([read(path) for path in paths]), messages)
    known = load_fixes(fixes, recorded, paths[0])
    prior = own.prior_of(recorded, known)
    config = config if prior is None else apply_profile(config, prior)
    bar.start_part("smoothing")
    with prefix_errors(", ".join(map(str, paths))):
        walk = pipeline.smooth_recording(recorded, config, known)
        learnt = own.learnt_from(recorded, walk.devices, config, known)
    bar.start_part("writing")
    digests = {name: digest for path in paths for name, digest in _digests(path, len(paths) > 1).items()}
    return write_results(folder, walk, recorded, config, digests, prior), learnt


def _digests(path: Path, several: bool) -> dict[str, str]:
    """Compute checksums by file; of several recordings by their paths, since files of one app have the same names."""
    digests = file_digests(path)
    if not several:
        return digests
    return {str(path) if path.is_file() else str(path / name): digest for name, digest in digests.items()}
