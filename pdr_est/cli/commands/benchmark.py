"""`pdr-est benchmark`: errors on public data sets, of one variant or of several side by side."""

import json
from contextlib import AbstractContextManager, ExitStack, nullcontext
from pathlib import Path

import click
from rich.console import Console

from pdr_est.cli.error_context import prefix_errors
from pdr_est.cli.options import PATH, Command, config_option, given_paths, resolve_config
from pdr_est.cli.progress import progress_bar
from pdr_est.config import Config
from pdr_est.errors import OutputError, RecordingError
from pdr_est.experiment.results.console_table import print_table
from pdr_est.experiment.results.score_rows import BenchmarkResult
from pdr_est.experiment.runners.score_walk import run_benchmark
from pdr_est.experiment.suites import SUITES
from pdr_est.experiment.variants.axes import AXES, EVERY, comparison_of_choices
from pdr_est.io.writers.atomic_output import staged_file
from pdr_est.performance import LENGTHS_MIN, print_speed, run_speed
from pdr_est.performance import NAME as SPEED

_REASONS = 3  # told at once


def _axis_options(command: Command) -> Command:
    """An option for each axis, named after it, which takes one of its values or "all" of them."""
    for axis in reversed(AXES):
        text = f"Default: {axis.of(Config())}; {EVERY} compares them."
        command = click.option(f"--{axis.word}", type=click.Choice((*axis.names, EVERY)), help=text)(command)
    return command


@click.command()
@click.argument("suite", type=click.Choice(sorted([*(suite.name for suite in SUITES), SPEED])))
@click.option("--data", type=PATH, metavar="DIR", help=f"Folder with the data sets; {SPEED} needs none.")
@_axis_options
@click.option("--json", "json_file", type=PATH, metavar="FILE", help="Write the numbers there as well.")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Processes.")
@click.option("--limit", type=click.IntRange(min=1), help="Only the first walks.")
@config_option
@click.option("-q", "--quiet", is_flag=True, help="No progress bar.")
def benchmark(
    suite: str,
    data: Path | None,
    json_file: Path | None,
    jobs: int,
    limit: int | None,
    config_file: Path | None,
    quiet: bool,
    **options_of_axes: str | None,
) -> None:
    """Score the walks of SUITE in DIR and print a table of its metrics; SUITE speed measures what the chain costs."""
    if suite == SPEED:
        _speed(json_file, data, limit, config_file, quiet)
        return
    if data is None:
        raise click.MissingParameter(param_type="option", param_hint="'--data'")
    choices = {name.replace("_", "-"): value for name, value in options_of_axes.items()}
    config = resolve_config(config_file)
    with nullcontext() if config_file is None else prefix_errors(config_file):
        comparison = comparison_of_choices(config, choices)
    with ExitStack() as stack:
        document = None if json_file is None else stack.enter_context(_staged_result(json_file, data, config_file))
        bar = stack.enter_context(progress_bar(suite, total=None, quiet=quiet))
        result = run_benchmark(suite, data, comparison, jobs, limit, on_progress=bar.set_progress)
        _refuse_empty(result, data)
        if document is not None:
            document.write_text(json.dumps(result.to_dict(), indent=2) + "\n", encoding="utf-8")
    print_table(result, Console())


def _speed(
    json_file: Path | None, data: Path | None, limit: int | None, config_file: Path | None, quiet: bool
) -> None:
    """The suite without walks. limit: how many of the lengths whose growth of cost is measured."""
    config = resolve_config(config_file)
    with ExitStack() as stack:
        document = None if json_file is None else stack.enter_context(_staged_result(json_file, data, config_file))
        bar = stack.enter_context(progress_bar(SPEED, total=None, quiet=quiet))
        result = run_speed(config, LENGTHS_MIN[:limit], on_progress=bar.set_progress)
        if document is not None:
            document.write_text(json.dumps(result.to_dict(), indent=2) + "\n", encoding="utf-8")
    print_speed(result, Console())


def _staged_result(json_file: Path, data: Path | None, config_file: Path | None) -> AbstractContextManager[Path]:
    """The place of the JSON document, which may replace an earlier one. Raises OutputError for any other file."""
    if json_file.is_file() and not _is_result(json_file):
        raise OutputError(f"{json_file}: is no result of an earlier benchmark: name another file")
    return staged_file(json_file, overwrite=True, inputs=given_paths(data, config_file))


def _is_result(path: Path) -> bool:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(document, dict) and {"suite", "version", "walks"} <= document.keys()


def _refuse_empty(result: BenchmarkResult, data: Path) -> None:
    """Raises RecordingError, with the first reasons, when no walk could be scored."""
    if result.rows:
        return
    reasons = [f"{walk.walk}: {walk.reason}" for walk in result.skipped[:_REASONS]]
    more = len(result.skipped) - len(reasons)
    words = "; ".join([*reasons, *([f"and {more} more"] if more else [])])
    raise RecordingError(f"{data}: no walk of the suite {result.suite} could be scored: {words}")
