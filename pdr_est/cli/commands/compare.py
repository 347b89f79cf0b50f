"""`pdr-est compare`: which variant of finished experiments is better, walk by walk."""

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from textwrap import fill

import click
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.table import Table

from pdr_est.cli.options import PATH
from pdr_est.evaluate.metric_definitions import DEFINITIONS, unit_of, with_unit
from pdr_est.evaluate.paired_comparison import Paired

_NARROWEST = 100  # columns: a narrower terminal wraps the lines, for no number or short name is ever cut
_WIDEST = 1000


@click.command()
@click.argument("folders", type=PATH, nargs=-1, required=True, metavar="OUT...")
@click.option("--reference", metavar="VARIANT", help="Compare the others with this one only.")
@click.option("--metric", "metrics", multiple=True, metavar="NAME", help="Only this metric; may be given again.")
@click.option("--track", metavar="NAME", help="Only the tracks of this device, or `fused`. Default: mean over them.")
@click.option("-o", "--output", type=PATH, metavar="DIR", help="Folder for the tables. Default: the first OUT.")
@click.option("-q", "--quiet", is_flag=True, help="Write the tables and print nothing.")
def compare(
    folders: tuple[Path, ...],
    reference: str | None,
    metrics: tuple[str, ...],
    track: str | None,
    output: Path | None,
    quiet: bool,
) -> None:
    """Compare the variants in the results OUT of `pdr-est experiment`, in pairs on the same walks.

    Prints the mean difference with its bootstrap interval and who wins on how many walks, and writes the same as
    compare.csv and compare.md.
    """
    from pdr_est.experiment.results.comparison import NOTE, as_csv, as_markdown, compare_variants, read_values
    from pdr_est.experiment.results.result_folder import COMPARED_CSV, COMPARED_TEXT, write

    pairs = compare_variants(read_values(folders, track, metrics), reference)
    folder = folders[0] if output is None else output
    folder.mkdir(parents=True, exist_ok=True)
    write(folder / COMPARED_CSV, as_csv(pairs))
    write(folder / COMPARED_TEXT, as_markdown(pairs))
    if not quiet:
        _print(pairs)
        click.echo(fill(f"{NOTE} The better one is bold where the interval does not hold 0.", _NARROWEST))


def _print(pairs: Sequence[Paired]) -> None:
    """A table for each metric, as wide as the terminal at most: names of variants wrap, numbers do not."""
    console = Console()
    same = []
    for metric, of_metric in groupby(pairs, key=lambda pair: pair.metric):
        different = [pair for pair in of_metric if pair.ties < pair.n]
        if different:
            console.print(_table(metric, different, max(console.width, _NARROWEST)), crop=False)
        else:
            same.append(metric)
    if same:
        click.echo(fill(f"The same with all variants on every walk: {', '.join(same)}.", _NARROWEST))


def _table(metric: str, pairs: Sequence[Paired], width: int) -> Table:
    ideal = f", ideal value {DEFINITIONS[metric].ideal:g}" if metric in DEFINITIONS else ""
    table = Table(
        title=f"{with_unit(metric)}{ideal}",
        title_justify="left",
        title_style="bold",
        box=box.SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
        pad_edge=False,
    )
    unit = unit_of(metric)
    below = f"\n({unit})" if unit else ""
    for name in ("A", "B"):
        table.add_column(name, overflow="fold")
    for heading in ("walks", f"mean A{below}", f"mean B{below}", f"B - A{below}", f"95 % interval{below}"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("wins\nA : B", justify="right", no_wrap=True)
    table.add_column("ties", justify="right", no_wrap=True)
    for pair in pairs:
        table.add_row(*_cells(pair))
    console = Console(width=_WIDEST)
    table.width = min(width, Measurement.get(console, console.options, table).maximum)
    return table


def _cells(pair: Paired) -> tuple[str, ...]:
    first, second = (
        f"[bold]{escape(name)}[/bold]" if pair.better == name else escape(name) for name in (pair.first, pair.second)
    )
    return (
        first,
        second,
        str(pair.n),
        f"{pair.mean_first:.3f}",
        f"{pair.mean_second:.3f}",
        f"{pair.difference:+.3f}",
        "" if pair.low is None or pair.high is None else f"{pair.low:+.3f} … {pair.high:+.3f}",
        f"{pair.first_wins} : {pair.second_wins}",
        str(pair.ties or ""),
    )
