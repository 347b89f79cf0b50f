"""`pdr-est smooth`: a recording becomes a folder with its track."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from pdr_est import pipeline
from pdr_est.calibration.profile import Profile, load_profile
from pdr_est.cli.clock_options import clock_options, with_clocks, with_messages
from pdr_est.cli.error_context import naming
from pdr_est.cli.fix_options import chosen_fixes
from pdr_est.cli.options import PATH, config_option, resolve_config, walker_options
from pdr_est.cli.progress import Bar, progress_bar
from pdr_est.clock_sync import ClockMethod
from pdr_est.config import Config
from pdr_est.io import read
from pdr_est.io.writers.atomic_output import staged_folder
from pdr_est.io.writers.checksums import file_digests
from pdr_est.preprocessing.merge import merge_recordings


@click.command()
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING…")
@click.option("-o", "--output", type=PATH, required=True, metavar="OUT", help="Folder for the results.")
@click.option("--fixes", metavar="FILE.csv|recording", help="Known positions: a table, or those in the recording.")
@click.option("--profile", type=PATH, metavar="FILE.yaml", help="The walker's own, made by `pdr-est calibrate`.")
@config_option
@walker_options
@clock_options
@click.option("--overwrite", is_flag=True, help="Replace the results of an earlier run in OUT.")
@click.option("-q", "--quiet", is_flag=True, help="No progress bar and no closing lines; warnings are still shown.")
def smooth(
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

    Several recordings are those of devices that one person carried at once.
    """
    walker = None if profile is None else load_profile(profile)
    config = with_clocks(resolve_config(**settings, profile=walker), clock, clock_offsets, messages)
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
    bar: Bar,
    profile: Profile | None = None,
    messages: Path | None = None,
) -> dict[str, Any]:
    """Read, smooth and write the recordings of one walk; return the summary. profile: what the configuration was made
    with. messages: by which the devices compared their clocks."""
    from pdr_est.report.walk.result_files import write_results  # matplotlib is slow to load

    recorded = with_messages(merge_recordings([read(path) for path in paths]), messages)
    known = chosen_fixes(fixes, recorded, paths[0])
    bar.doing("walking")
    with naming(", ".join(map(str, paths))):
        walk = pipeline.smooth(recorded, config, known)
    bar.doing("writing")
    digests = {name: digest for path in paths for name, digest in _digests(path, len(paths) > 1).items()}
    return write_results(folder, walk, recorded, config, digests, profile)


def _digests(path: Path, several: bool) -> dict[str, str]:
    """Checksums by file; of several recordings by the path of each, for folders of one app have files of one name."""
    digests = file_digests(path)
    if not several:
        return digests
    return {str(path) if path.is_file() else str(path / name): digest for name, digest in digests.items()}
