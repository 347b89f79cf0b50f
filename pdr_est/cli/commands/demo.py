"""`pdr-est demo`: the whole processing on a simulated walk, whose truth is known."""

from pathlib import Path
from typing import Any

import click

from pdr_est.cli.options import OUTPUT
from pdr_est.module_loading import loading_modules


@click.command("demo")
@click.option(
    "-o", "--output", type=OUTPUT, default=Path("demo-out"), show_default=True, help="Folder for the results."
)
@click.option("--preset", "name", default="office_loop", show_default=True, help="Simulated walk.")
@click.option("-q", "--quiet", is_flag=True, help="Show no progress bar and no summary.")
def demo_command(**options: Any) -> None:
    """Simulate a walk with a held phone, smooth it and write the report. No recording is needed."""
    with loading_modules():
        from pdr_est.cli.work.demo import run_demo

    run_demo(**options)
