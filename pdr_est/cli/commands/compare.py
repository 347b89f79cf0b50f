"""`pdr-est compare`: which variant of finished experiments is better, walk by walk."""

from pathlib import Path

import click

from pdr_est.cli.options import OUTPUT, PATH
from pdr_est.module_loading import loading_modules


@click.command()
@click.argument("folders", type=PATH, nargs=-1, required=True, metavar="OUT...")
@click.option("--reference", metavar="VARIANT", help="Compare the others with this one only.")
@click.option("--metric", "metrics", multiple=True, metavar="NAME", help="Only this metric; may be given again.")
@click.option("--track", metavar="NAME", help="Only the tracks of this device, or `fused`. Default: mean over them.")
@click.option("-o", "--output", type=OUTPUT, metavar="DIR", help="Folder for the tables. Default: the first OUT.")
@click.option("--overwrite", is_flag=True, help="Replace tables of that name that pdr-est did not write.")
@click.option("-q", "--quiet", is_flag=True, help="Write the tables and print nothing.")
def compare(
    folders: tuple[Path, ...],
    reference: str | None,
    metrics: tuple[str, ...],
    track: str | None,
    output: Path | None,
    overwrite: bool,
    quiet: bool,
) -> None:
    """Compare the variants in the results OUT of `pdr-est experiment`, in pairs on the same walks.

    Prints the mean difference with its bootstrap interval and who wins on how many walks, and writes the same as
    compare.csv and compare.md.
    """
    from rich.console import Console

    with loading_modules():
        from pdr_est.experiment.results.comparison import (
            as_csv,
            as_markdown,
            compare_variants,
            read_aligned,
            read_values,
        )
        from pdr_est.experiment.results.console_tables import print_comparison
        from pdr_est.experiment.results.result_folder import COMPARED_CSV, COMPARED_TEXT, compared_files
        from pdr_est.output.own_files import OwnFiles

    pairs = compare_variants(read_values(folders, track, metrics), reference)
    aligned = read_aligned(folders)
    own = OwnFiles(folders[0] if output is None else output, compared_files(folders))
    if not overwrite:
        own.refuse_foreign([COMPARED_CSV, COMPARED_TEXT])
    own.write(COMPARED_CSV, as_csv(pairs), overwrite)
    own.write(COMPARED_TEXT, as_markdown(pairs, aligned), overwrite)
    if not quiet:
        print_comparison(pairs, Console(), aligned)
