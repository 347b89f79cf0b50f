"""`pdr-est smooth`: a recording becomes a folder with its track."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from pdr_est import pipeline
from pdr_est.cli.fixes import chosen_fixes
from pdr_est.cli.naming import naming
from pdr_est.cli.options import PATH, config_option, resolve_config, walker_options
from pdr_est.cli.progress import Bar, progress_bar
from pdr_est.config import Config
from pdr_est.io import read
from pdr_est.io.digest import file_digests
from pdr_est.io.output import staged_folder
from pdr_est.io.together import together
from pdr_est.profile import Profile, load_profile


@click.command()
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING…")
@click.option("-o", "--output", type=PATH, required=True, metavar="OUT", help="Folder for the results.")
@click.option("--fixes", metavar="FILE.csv|recording", help="Known positions: a table, or those in the recording.")
@click.option("--profile", type=PATH, metavar="FILE.yaml", help="The walker's own, made by `pdr-est calibrate`.")
@config_option
@walker_options
@click.option("--overwrite", is_flag=True, help="Replace the results of an earlier run in OUT.")
@click.option("-q", "--quiet", is_flag=True, help="No progress bar and no closing lines; warnings are still shown.")
def smooth(
    recordings: tuple[Path, ...],
    output: Path,
    fixes: str | None,
    profile: Path | None,
    overwrite: bool,
    quiet: bool,
    **settings: Any,
) -> None:
    """Turn RECORDING (a file, a folder or a zip) into a track with uncertainty, its files and its report.

    Several recordings are those of devices that one person carried at once.
    """
    walker = None if profile is None else load_profile(profile)
    config = resolve_config(**settings, profile=walker)
    with progress_bar("reading", total=4, quiet=quiet) as bar, staged_folder(output, overwrite) as folder:
        summary = smooth_into(folder, recordings, fixes, config, bar, walker)
    for warning in summary["warnings"]:
        click.echo(f"warning: {warning}", err=True)
    if not quiet:
        counts = summary["counts"]["steps"].values()
        steps = round(sum(counts) / len(counts))  # of one walker, seen by each device
        click.echo(f"{summary['distance_m'] or 0.0:.1f} m in {steps} steps -> {output / 'report.html'}")


def smooth_into(
    folder: Path, paths: Sequence[Path], fixes: str | None, config: Config, bar: Bar, profile: Profile | None = None
) -> dict[str, Any]:
    """Read, smooth and write the recordings of one walk; return the summary. profile: what the configuration was made
    with."""
    from pdr_est.report.results import write_results  # matplotlib is slow to load

    recorded = together([read(path) for path in paths])
    known = chosen_fixes(fixes, recorded, paths[0])
    bar.doing("walking")
    with naming(paths[0] if len(paths) == 1 else paths[0].parent):
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
