"""Write the table of the detected steps of a walk."""

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from pdr_est.output.atomic_output import text_output
from pdr_est.output.csv_cells import harmless_name
from pdr_est.types.steps import Step

STEP_COLUMNS = (
    "time_s",
    "device",
    "index",
    "segment",
    "mode",
    "mode_probability",
    "gait",
    "gait_probability",
    "frequency_hz",
    "length_m",
    "heading_rad",
    "confidence",
)


def write_steps_csv(steps: Mapping[str, Sequence[Step]], path: str | Path) -> None:
    """Write one row for each step, with the columns `STEP_COLUMNS`, device by device.

    `heading_rad` is the mean yaw of the device over the step (with an arbitrary zero), not the heading of the
    track. `gait_probability` is that of the gait in the cell before it. A value that was not determined is an empty
    cell, an unknown mode or gait is UNKNOWN.

    Parameters
    ----------
    steps
        Device name -> its steps.
    path
        File to write.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    with text_output(path) as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(STEP_COLUMNS)
        for device, of_device in steps.items():
            writer.writerows(_step_row(device, step) for step in of_device)


def _step_row(device: str, step: Step) -> tuple[str | int, ...]:
    return (
        f"{step.event.time_s:.6f}",
        harmless_name(device),
        step.event.index,
        step.event.segment,
        step.event.mode.name,
        _cell(step.event.mode_probability, 4),
        step.gait.name,
        _cell((math.nan, *step.gait_probability)[step.gait], 4),
        _cell(step.frequency_hz, 4),
        _cell(step.length_m, 4),
        _cell(step.heading_rad, 6),
        _cell(step.event.confidence, 4),
    )


def _cell(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else ""
