"""`pdr-est smooth`: a recording becomes a folder with its track."""

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
from pdr_est.profile import Profile, load_profile


@click.command()
@click.argument("recording", type=PATH)
@click.option("-o", "--output", type=PATH, required=True, metavar="OUT", help="Folder for the results.")
@click.option("--fixes", metavar="FILE.csv|recording", help="Known positions: a table, or those in the recording.")
@click.option("--profile", type=PATH, metavar="FILE.yaml", help="The walker's own, made by `pdr-est calibrate`.")
@config_option
@walker_options
@click.option("--overwrite", is_flag=True, help="Replace the results of an earlier run in OUT.")
@click.option("-q", "--quiet", is_flag=True, help="No progress bar and no closing lines; warnings are still shown.")
def smooth(
    recording: Path,
    output: Path,
    fixes: str | None,
    profile: Path | None,
    overwrite: bool,
    quiet: bool,
    **settings: Any,
) -> None:
    """Turn RECORDING (a file, a folder or a zip) into a track with uncertainty, its files and its report."""
    walker = None if profile is None else load_profile(profile)
    config = resolve_config(**settings, profile=walker)
    with progress_bar("reading", total=4, quiet=quiet) as bar, staged_folder(output, overwrite) as folder:
        summary = smooth_into(folder, recording, fixes, config, bar, walker)
    for warning in summary["warnings"]:
        click.echo(f"warning: {warning}", err=True)
    if not quiet:
        steps = sum(summary["counts"]["steps"].values())
        click.echo(f"{summary['distance_m'] or 0.0:.1f} m in {steps} steps -> {output / 'report.html'}")


def smooth_into(
    folder: Path, path: Path, fixes: str | None, config: Config, bar: Bar, profile: Profile | None = None
) -> dict[str, Any]:
    """Read, smooth and write one recording; return its summary. profile: what the configuration was made with."""
    from pdr_est.report.results import write_results  # matplotlib is slow to load

    recorded = read(path)
    known = chosen_fixes(fixes, recorded, path)
    bar.doing("walking")
    with naming(path):
        walk = pipeline.smooth(recorded, config, known)
    bar.doing("writing")
    return write_results(folder, walk, recorded, config, file_digests(path), profile)
