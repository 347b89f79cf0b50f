"""The suite `speed` on the terminal."""

from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.table import Table

from pdr_est.benchmark.speed.run import SpeedResult


def print_speed(result: SpeedResult, console: Console) -> None:
    """The same numbers as in the JSON document."""
    stages = Table(title="CPU seconds a minute of a two-phone recording at 50 Hz")
    stages.add_column("stage", no_wrap=True)
    stages.add_column("seconds", justify="right")
    for name, seconds in result.stage_seconds.items():
        stages.add_row(name, f"{seconds:.4f}")
    console.print(stages)
    console.print(_table("smoothing and bare GTSAM, CPU seconds", result.smoothing))
    console.print(_table("growth of smoothing with the length of a walk", result.growth))
    if result.online is not None:
        console.print(_table("online", [result.online]))


def _table(title: str, rows: Sequence[Mapping[str, float]]) -> Table:
    table = Table(title=title)
    for name in rows[0] if rows else ():
        table.add_column(name, justify="right")
    for row in rows:
        table.add_row(
            *(f"{value:.0f}" if value.is_integer() else f"{value:.3f}" for value in map(float, row.values()))
        )
    return table
