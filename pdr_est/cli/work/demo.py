"""Work of `pdr-est demo`: simulate, smooth, write, and compare with the truth."""

from pathlib import Path
from typing import Any

import click

from pdr_est import pipeline
from pdr_est.cli.progress import progress_bar
from pdr_est.config import Config
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.output.atomic_output import staged_folder, written_files
from pdr_est.simulate import preset, simulate_walk
from pdr_est.types.ground_truth import Truth

RECORDING = "simulated-walk.csv"


def run_demo(output: Path, name: str, quiet: bool) -> None:
    """Simulate a walk, smooth it and write the report."""
    from pdr_est.report.walk.result_files import write_results  # matplotlib is slow to load

    with (
        progress_bar("simulating", total=3, quiet=quiet) as bar,
        staged_folder(output, RECORDING in written_files(output), inputs=()) as folder,
    ):
        recording = simulate_walk(preset(name)).recording
        write_plain_csv(recording, folder / RECORDING)
        bar.start_part("smoothing")
        walk = pipeline.smooth_recording(recording, Config())
        bar.start_part("writing")
        summary = write_results(folder, walk, recording, Config(), {RECORDING: None})
    if not quiet:
        _report(name, output, summary, recording.truth)


def _report(name: str, output: Path, summary: dict[str, Any], truth: Truth) -> None:
    """Print the track beside the truth, and what to do next."""
    errors, steps = summary["errors_against_truth"], sum(summary["counts"]["steps"].values())
    click.echo(f"Simulated walk {name}: {summary['distance_m']:.1f} m in {steps} steps.")
    click.echo(f"  true steps {truth.step_count}, true distance {truth.distance_m:.1f} m")
    click.echo(f"  root mean square error {errors['ate_rigid_m']:.2f} m after the best rigid alignment")
    click.echo(f"  error at the end {100.0 * errors['final_drift']:.2f} % of the distance")
    click.echo(f"Report: {output / 'report.html'}")
    click.echo("With a recording of your own: pdr-est smooth RECORDING -o OUT --height 1.75 --gender female")
