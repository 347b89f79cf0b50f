"""Work of `pdr-est plan`: read a plan or make it of a picture, describe it, and write its page."""

from pathlib import Path

import click

from pdr_est.cli.call_paths import input_paths
from pdr_est.io.floor_plans.picture import KnownPoint, read_plan_picture
from pdr_est.io.floor_plans.reading import read_floor_plan
from pdr_est.io.floor_plans.writing import write_floor_plan
from pdr_est.output.atomic_output import staged_folder, write_text
from pdr_est.report.floor_plans.description import plan_rows
from pdr_est.types.floor_plan import FloorPlan

_FARTHEST_M = 1e8

PAGE, DRAWING = "plan.html", "plan.geojson"


def describe_plan(
    plan: Path,
    floor: str | None,
    output: Path | None,
    start: tuple[float, float] | None,
    points: tuple[tuple[float, float, float, float], ...],
    darkness: float | None,
    inside: tuple[tuple[float, float], ...],
    overwrite: bool,
    quiet: bool,
) -> None:
    """Print what a plan shows, and write its page and its drawing if a folder is given."""
    if start is not None and not all(abs(one) < _FARTHEST_M for one in start):  # false for NaN, too
        raise click.UsageError(f"--start {start[0]:g} {start[1]:g}: is no position on a plan: give metres")
    found = _plan(plan, floor or "", points, darkness, inside)
    rows = plan_rows(found, start)
    if output is not None:
        with staged_folder(output, overwrite, input_paths()) as folder:
            from pdr_est.report.floor_plans.page import render_plan  # matplotlib is slow to load

            write_text(folder / PAGE, render_plan(found, rows, start))
            write_floor_plan(found, folder / DRAWING)
    if not quiet:
        width = max(len(label) for label, _ in rows)
        for label, value in rows:
            click.echo(f"{label:<{width}}  {value}")
        if output is not None:
            click.echo(f"-> {output / PAGE}")


def _plan(
    path: Path,
    floor: str,
    points: tuple[tuple[float, float, float, float], ...],
    darkness: float | None,
    inside: tuple[tuple[float, float], ...],
) -> FloorPlan:
    if points:
        known = [KnownPoint(*one) for one in points]
        return read_plan_picture(path, known, darkness=darkness, inside_m=inside, floor=floor)
    if darkness is not None or inside:
        raise click.UsageError("--darkness and --inside are about pictures: give two known points (--point), too")
    return read_floor_plan(path, floor)
