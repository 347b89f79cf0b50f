"""`pdr-est compare`: which variant of finished experiments is better, walk by walk."""

from itertools import groupby
from pathlib import Path

import click
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pdr_est.cli.options import PATH
from pdr_est.evaluate.definitions import DEFINITIONS, unit_of
from pdr_est.evaluate.paired import Paired

_NARROWEST = 60  # columns: below it a terminal wraps the lines rather than the names of variants letter by letter


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
    from pdr_est.experiment.comparison import NOTE, as_csv, as_markdown, compare_variants, read_values
    from pdr_est.experiment.output import COMPARED_CSV, COMPARED_TEXT, write

    pairs = compare_variants(read_values(folders, track), reference, metrics)
    folder = folders[0] if output is None else output
    folder.mkdir(parents=True, exist_ok=True)
    write(folder / COMPARED_CSV, as_csv(pairs))
    write(folder / COMPARED_TEXT, as_markdown(pairs))
    if not quiet:
        _print(pairs)
        click.echo(NOTE)


def _print(pairs: tuple[Paired, ...]) -> None:
    """A table for each metric, no wider than the terminal: names of variants wrap, numbers do not."""
    console = Console()
    for metric, of_metric in groupby(pairs, key=lambda pair: pair.metric):
        console.print(_table(metric, list(of_metric), max(console.width, _NARROWEST)), crop=False)


def _table(metric: str, pairs: list[Paired], width: int) -> Table:
    unit = unit_of(metric)
    ideal = f", ideal {DEFINITIONS[metric].ideal:g}" if metric in DEFINITIONS else ""
    table = Table(
        title=f"{metric}{f' in {unit}' if unit else ''}{ideal}",
        title_justify="left",
        title_style="bold",
        box=box.SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
    )
    table.add_column("A", overflow="fold")
    table.add_column("B", overflow="fold")
    of = f", {unit}" if unit else ""
    for heading in ("walks", f"mean A{of}", f"mean B{of}", f"B - A{of}", f"95 % interval{of}", "wins A:B (ties)"):
        table.add_column(heading, justify="right", no_wrap=True)
    for pair in pairs:
        names = (escape(name) for name in (pair.first, pair.second))
        first, second = (
            f"[bold]{name}[/bold]" if pair.better == own else name
            for name, own in zip(names, (pair.first, pair.second), strict=True)
        )
        interval = "" if pair.low is None or pair.high is None else f"{pair.low:+.3f} … {pair.high:+.3f}"
        wins = f"{pair.first_wins}:{pair.second_wins}" + (f" ({pair.ties})" if pair.ties else "")
        table.add_row(
            first,
            second,
            str(pair.n),
            f"{pair.mean_first:.3f}",
            f"{pair.mean_second:.3f}",
            f"{pair.difference:+.3f}",
            interval,
            wins,
        )
    table.width = min(width, _wanted(table))
    return table


def _wanted(table: Table) -> int:
    from rich.measure import Measurement

    console = Console(width=1000)
    return Measurement.get(console, console.options, table).maximum
