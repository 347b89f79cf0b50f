"""`pdr-est experiment`: comparison of variants on many walks, as a file describes it."""

from pathlib import Path

import click

from pdr_est.cli.options import OUTPUT, PATH
from pdr_est.errors import RecordingError
from pdr_est.module_loading import loading_modules

_REASONS = 3  # named in the error


@click.command()
@click.argument("config", type=PATH)
@click.option("-o", "--output", type=OUTPUT, required=True, metavar="OUT", help="Folder for the results.")
@click.option("--data", type=PATH, metavar="DIR", help="Folder of the recordings, instead of the file's.")
@click.option("--limit", type=click.IntRange(min=1), help="Only the first walks.")
@click.option("--workers", type=click.IntRange(min=1), default=1, show_default=True, help="Processes.")
@click.option("--cluster", metavar="ADDRESS", help="Dask scheduler that has the work done, such as tcp://host:8786.")
@click.option("--overwrite", is_flag=True, help="Do all anew, and replace other results in OUT.")
@click.option("-q", "--quiet", is_flag=True, help="No progress bar and no closing lines.")
def experiment(
    config: Path,
    output: Path,
    data: Path | None,
    limit: int | None,
    workers: int,
    cluster: str | None,
    overwrite: bool,
    quiet: bool,
) -> None:
    """Run the experiment that the file CONFIG describes.

    A run that was stopped goes on where it was when it is started again with the same words.
    """
    with loading_modules():
        from pdr_est.cli.progress import progress_bar
        from pdr_est.experiment import load_experiment, run_experiment

    loaded = load_experiment(config, data, limit)
    with progress_bar(loaded.title, total=len(loaded.walks), quiet=quiet) as bar:
        finished = run_experiment(loaded, output, workers, cluster, overwrite, on_progress=bar.set_progress)
    if finished.failed == len(finished.results):
        failures = [failure for result in finished.results for failure in result.failures]
        reasons = "; ".join(f"{failure.walk}: {failure.reason}" for failure in failures[:_REASONS])
        raise RecordingError(f"{config}: no walk could be scored: {reasons}; all reasons: {output / 'failed.csv'}")
    if quiet:
        return
    if finished.resumed:
        click.echo(f"{finished.resumed} of {len(finished.results)} walks were there from an earlier run.")
    if finished.failed:
        click.echo(f"{finished.failed} of {len(finished.results)} walks failed: {output / 'failed.csv'}", err=True)
    click.echo(f"{len(finished.results)} walks x {len(loaded.variants)} variants -> {output / 'report.html'}")
    click.echo(f"Who is better: pdr-est compare {output}")
