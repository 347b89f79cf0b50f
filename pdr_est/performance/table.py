"""Tables of the suite `speed` on the terminal."""

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from pdr_est.performance.run import SpeedResult
from pdr_est.performance.whole_chain import TEXTBOOK_CHAIN, VQF_ALONE


def print_speed(result: SpeedResult, console: Console) -> None:
    """Print the numbers of the JSON document."""
    console.print(_chain_table(result.chains))
    console.print(_stage_table(result))
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


def _stage_table(result: SpeedResult) -> Table:
    """Make the table of the stages; their yardsticks are those of two phones in the table of the chains."""
    yardsticks = {row["chain"]: row["seconds_per_minute"] for row in result.chains if row["devices"] == 2}
    table = Table(title="each stage of two phones at 50 Hz, CPU time as a multiple of the textbook chain and of VQF")
    table.add_column("stage", no_wrap=True)
    for title in ("× textbook", "× VQF", "seconds a minute"):
        table.add_column(title, justify="right")
    for name, seconds in result.stage_seconds.items():
        multiples = [f"{seconds / yardsticks[chain]:.2f}" for chain in (TEXTBOOK_CHAIN, VQF_ALONE)]
        table.add_row(name, *multiples, f"{seconds:.4f}")
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
