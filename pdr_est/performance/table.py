"""Tables of the suite `speed` on the terminal."""

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from pdr_est.performance.run import SpeedResult


def print_speed(result: SpeedResult, console: Console) -> None:
    """Print the numbers of the JSON document."""
    console.print(_chain_table(result.chains))
    stages = Table(title="CPU seconds a minute of a two-phone recording at 50 Hz")
    stages.add_column("stage", no_wrap=True)
    stages.add_column("seconds", justify="right")
    for name, seconds in result.stage_seconds.items():
        stages.add_row(name, f"{seconds:.4f}")
    console.print(stages)
    console.print(_table("smoothing and bare GTSAM, CPU seconds", result.smoothing))
    console.print(_table("growth of smoothing with the length of a walk", result.growth))
    online = Table(title="online, ms a push of one sample, two phones at 100 Hz")
    online.add_column("estimator", no_wrap=True)
    for name in next(iter(result.online.values()), ()):
        online.add_column(name, justify="right")
    for estimator, found in result.online.items():
        online.add_row(estimator, *map(_number, found.values()))
    console.print(online)


def _chain_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    table = Table(title="recording to track, CPU time as a multiple of the textbook chain and of VQF")
    table.add_column("phones", justify="right")
    table.add_column("chain", no_wrap=True)
    for title in ("× textbook", "× VQF", "seconds a minute"):
        table.add_column(title, justify="right")
    for row in rows:
        multiples = [f"{row[name]:.1f}" for name in ("over_textbook", "over_vqf")]
        table.add_row(str(row["devices"]), row["chain"], *multiples, f"{row['seconds_per_minute']:.4f}")
    return table


def _table(title: str, rows: Sequence[Mapping[str, float]]) -> Table:
    table = Table(title=title)
    for name in rows[0] if rows else ():
        table.add_column(name, justify="right")
    for row in rows:
        table.add_row(*map(_number, row.values()))
    return table


def _number(value: float) -> str:
    return f"{value:.0f}" if float(value).is_integer() else f"{value:.3f}"
