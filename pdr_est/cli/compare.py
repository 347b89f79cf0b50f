"""`pdr-est compare`: which variant of finished experiments is better, walk by walk."""

from pathlib import Path

import click
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table

from pdr_est.cli.options import PATH
from pdr_est.evaluate.paired import Paired

_WIDEST = 1000  # columns; no number is ever shortened, a narrow terminal wraps the lines instead


@click.command()
@click.argument("folders", type=PATH, nargs=-1, required=True, metavar="OUT...")
@click.option("--reference", metavar="VARIANT", help="Compare the others with this one only.")
@click.option("--metric", "metrics", multiple=True, metavar="NAME", help="Only this metric; may be given again.")
@click.option("-o", "--output", type=PATH, metavar="DIR", help="Folder for the tables. Default: the first OUT.")
@click.option("-q", "--quiet", is_flag=True, help="Write the tables and print nothing.")
def compare(
    folders: tuple[Path, ...], reference: str | None, metrics: tuple[str, ...], output: Path | None, quiet: bool
) -> None:
    """Compare the variants in the results OUT of `pdr-est experiment`, in pairs on the same walks.

    Prints the mean difference with its bootstrap interval and who wins on how many walks, and writes the same as
    compare.csv and compare.md.
    """
    from pdr_est.experiment.comparison import NOTE, as_csv, as_markdown, compare_variants, read_values
    from pdr_est.experiment.output import COMPARED_CSV, COMPARED_TEXT, write

    pairs = compare_variants(read_values(folders), reference, metrics)
    folder = folders[0] if output is None else output
    folder.mkdir(parents=True, exist_ok=True)
    write(folder / COMPARED_CSV, as_csv(pairs))
    write(folder / COMPARED_TEXT, as_markdown(pairs))
    if not quiet:
        _print(pairs)
        click.echo(NOTE)


def _print(pairs: tuple[Paired, ...]) -> None:
    from pdr_est.experiment.comparison import HEADINGS, as_rows

    table = Table(title="walk by walk")
    for number, heading in enumerate(HEADINGS):
        table.add_column(heading, justify="left" if number < 3 else "right", no_wrap=True)
    for row, pair in zip(as_rows(pairs), pairs, strict=True):
        first, second = (f"[bold]{name}[/bold]" if pair.better == name else name for name in (row[1], row[2]))
        table.add_row(row[0], first, second, *row[3:])
    console = Console()
    table.width = Measurement.get(console, console.options.update(width=_WIDEST), table).maximum
    console.print(table, crop=False)
