"""`pdr-est train-gait`: the gait model from its data sets, or one from recordings of your own."""

from datetime import date, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pdr_est.cli.options import OUTPUT, PATH
from pdr_est.module_loading import loading_modules

if TYPE_CHECKING:
    from pdr_est.front_end.gait.features import FeatureSet


@click.command("train-gait")
@click.option("--data", type=PATH, required=True, metavar="DIR", help="Folder with the recordings.")
@click.option("-o", "--output", type=OUTPUT, required=True, metavar="OUT", help="Folder for the model and its card.")
@click.option(
    "--features",
    type=click.Choice(("auto", "uptime")),
    default="auto",
    show_default=True,
    help="Features of a stride (auto), or those of a step as in the paper (uptime).",
)
@click.option(
    "--date",
    "trained_on",
    type=click.DateTime(["%Y-%m-%d"]),
    help="Date on the model card. Default: today. The model has no date: the same recordings give the same bytes.",
)
@click.option("--overwrite", is_flag=True, help="Replace the results of an earlier run in OUT.")
@click.option("-q", "--quiet", is_flag=True, help="Show no progress bar.")
def train_gait_command(
    data: Path, output: Path, features: "FeatureSet", trained_on: datetime | None, overwrite: bool, quiet: bool
) -> None:
    """Train the classifier of walking, jogging and running on the recordings in DIR.

    \b
    DIR holds any of these, files plain or gzipped:
      motionsense/{wlk,jog}_N/sub_PERSON.csv
      sisfall/PERSON/D0{1,2,3,4}_PERSON_R01.txt
      {walking,jogging,running}/PERSON/RECORDING...
    The last is for recordings of your own, in any format that `pdr-est inspect` knows. At least three people must
    walk, and three must jog and run. Use the model with gait.model in a configuration file.
    """  # noqa: D301  click reads the character \b
    with loading_modules():
        from pdr_est.cli.call_paths import input_paths
        from pdr_est.cli.progress import progress_bar
        from pdr_est.output.atomic_output import staged_folder
        from pdr_est.training.gait_files import recordings_digest
        from pdr_est.training.gait_training import (
            train_gait,  # scikit-learn loads slowly
            write_trained,
        )

    with staged_folder(output, overwrite, input_paths()) as folder:
        with progress_bar("gait", total=None, quiet=quiet) as bar:
            trained = train_gait(data, features, on_progress=bar.set_progress)
        day = date.today() if trained_on is None else trained_on.date()
        write_trained(trained, folder, day, recordings_digest(data))
    metrics = trained.model.metrics
    if metrics is not None:
        click.echo(
            f"{output}: {len(trained.model.people)} people; leave-one-person-out accuracy "
            f"{100.0 * metrics.faster_accuracy['all']:.2f} % for walking or faster, "
            f"{100.0 * metrics.balanced_accuracy['all']:.2f} % (balanced) for the three gaits"
        )
