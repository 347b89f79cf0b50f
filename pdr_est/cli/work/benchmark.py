"""Work of `pdr-est benchmark`: score a suite, write its numbers and print its table."""

import json
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from pdr_est.cli.call_paths import input_paths
from pdr_est.cli.error_context import prefix_errors
from pdr_est.cli.progress import progress_bar
from pdr_est.cli.settings import resolve_config
from pdr_est.errors import OutputError, RecordingError
from pdr_est.experiment import BenchmarkResult, print_benchmark, run_benchmark
from pdr_est.experiment.variants.axes import comparison_from_options
from pdr_est.output.atomic_output import staged_file
from pdr_est.performance import LENGTHS_MIN, print_speed, run_speed
from pdr_est.performance import NAME as SPEED

_REASONS = 3  # named in the error


def score_suite(
    suite: str,
    data: Path | None,
    json_file: Path | None,
    jobs: int,
    limit: int | None,
    turn_device: str | None,
    config_file: Path | None,
    quiet: bool,
    **options_of_axes: str | None,
) -> None:
    """Score the walks of a suite, or measure what the chain costs, and print the table."""
    if data is None and suite != SPEED:
        raise click.MissingParameter(param_type="option", param_hint="'--data'")
    config = resolve_config(config_file)
    console = Console()
    if data is None or suite == SPEED:
        with _document(json_file) as document, progress_bar(SPEED, total=None, quiet=quiet) as bar:
            speed = run_speed(config, LENGTHS_MIN[:limit], on_progress=bar.set_progress)
            document.update(speed.to_dict())
        print_speed(speed, console)
        return
    options = {name.replace("_", "-"): value for name, value in options_of_axes.items()}
    with nullcontext() if config_file is None else prefix_errors(config_file):
        comparison = comparison_from_options(config, options)
    with _document(json_file) as document, progress_bar(suite, total=None, quiet=quiet) as bar:
        result = run_benchmark(suite, data, comparison, jobs, limit, bar.set_progress, turn_device)
        _refuse_empty(result, data)
        document.update(result.to_dict())
    print_benchmark(result, console)


@contextmanager
def _document(json_file: Path | None) -> Iterator[dict[str, Any]]:
    """Give a dictionary that becomes the JSON file, which may replace an earlier result but no other file."""
    document: dict[str, Any] = {}
    if json_file is None:
        yield document
        return
    if json_file.is_file() and not _is_result(json_file):
        raise OutputError(f"{json_file}: is no result of an earlier benchmark: name another file")
    with staged_file(json_file, overwrite=True, inputs=input_paths()) as staging:
        yield document
        staging.write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")


def _is_result(path: Path) -> bool:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(document, dict) and {"suite", "version", "walks"} <= document.keys()


def _refuse_empty(result: BenchmarkResult, data: Path) -> None:
    """Raise RecordingError, with the first reasons, if no walk could be scored by any metric."""
    if any(value is not None for row in result.rows for value in row.metrics.values()):
        return
    reasons = [f"{failure.walk}: {failure.reason}" for failure in result.failures[:_REASONS]]
    more = len(result.failures) - len(reasons)
    words = "; ".join([*reasons, *([f"and {more} more"] if more else [])])
    raise RecordingError(f"{data}: no walk of the suite {result.suite.name} could be scored: {words}")
