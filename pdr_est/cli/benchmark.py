"""`pdr-est benchmark`: the errors of the estimators on public data sets."""

import json
from pathlib import Path

import click
from rich.console import Console

from pdr_est.benchmark.runner import run_benchmark
from pdr_est.benchmark.suites import SUITES
from pdr_est.benchmark.table import print_table
from pdr_est.cli.options import EXISTING, config_option, resolve_config
from pdr_est.cli.progress import progress_bar
from pdr_est.errors import OutputError
from pdr_est.estimators import ESTIMATORS


@click.command()
@click.argument("suite", type=click.Choice(sorted(suite.name for suite in SUITES)))
@click.option("--data", type=EXISTING, required=True, metavar="DIR", help="Folder with the data sets.")
@click.option("--estimator", type=click.Choice((*ESTIMATORS, "all")), help="Default: factor-graph.")
@click.option("--json", "json_file", type=EXISTING, metavar="FILE", help="Write the numbers there as well.")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Processes.")
@click.option("--limit", type=click.IntRange(min=1), help="Only the first walks.")
@config_option
@click.option("-q", "--quiet", is_flag=True, help="No progress bar.")
def benchmark(
    suite: str,
    data: Path,
    estimator: str | None,
    json_file: Path | None,
    jobs: int,
    limit: int | None,
    config_file: Path | None,
    quiet: bool,
) -> None:
    """Score the walks of SUITE in DIR and print a table of its metrics."""
    every = estimator == "all"
    config = resolve_config(config_file, None if every else estimator, None, None, None, None, None)
    estimators = ESTIMATORS if every else (config.estimator.name,)
    with progress_bar(suite, total=None, quiet=quiet) as bar:
        result = run_benchmark(suite, data, config, estimators, jobs, limit, on_progress=bar.at)
    if json_file is not None:
        _write(json_file, json.dumps(result.to_dict(), indent=2) + "\n")
    print_table(result, Console())


def _write(path: Path, text: str) -> None:
    """Write a file completely or not at all."""
    staging = path.with_name(f".{path.name}.partial")
    try:
        staging.write_text(text, encoding="utf-8")
        staging.replace(path)
    except OSError as error:
        staging.unlink(missing_ok=True)
        raise OutputError(f"{path}: cannot be written ({error.strerror}): choose another place for --json") from error
