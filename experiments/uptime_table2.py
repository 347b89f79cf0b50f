"""Table II of UPTIME (Alzantot and Youssef 2012) beside the lengths that our models give to real walking and jogging.

    python experiments/uptime_table2.py --data DIR

DIR holds `motionsense` (phone in the front trouser pocket) and `sisfall` (box at the belt). No length or speed is
known there: the numbers show whether the models are plausible, not whether they are right. Everybody counts as 1.73 m
tall. The gaits of the steps are those of the shipped model, which has seen these people. Prints the table and writes
it to experiments/results/ and experiments/paper-details.md.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from recorded import command_line, markdown_table, write, write_table

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.experiment.suites import gait
from pdr_est.frames import Array
from pdr_est.front_end.step_length import LENGTH_MODELS, StepLength, StepLengthParams
from pdr_est.io import read
from pdr_est.types.steps import Step

MARK = "<!-- uptime table 2 -->"
PAPER_M = {"walking": 0.74, "jogging": 1.01, "running": 1.70}
MODELS = ("auto", "range-power", "gait-table")
GROUPS = {  # activity of a file: what is walked, and the paper's gait
    "wlk": ("pocket, walking", "walking"),
    "jog": ("pocket, jogging", "jogging"),
    "D01": ("belt, slow walk", "walking"),
    "D02": ("belt, quick walk", "walking"),
    "D03": ("belt, slow jog", "jogging"),
    "D04": ("belt, quick jog", "running"),
}

Row = dict[str, Any]


@dataclass(frozen=True)
class Walk:
    """Step lengths of one recording by model, m, with the duration of all steps and the key of its group."""

    activity: str
    duration_s: float
    length_m: Mapping[str, Array]

    def mean_m(self, model: str) -> float:
        """Compute the mean length of a step, m."""
        return float(self.length_m[model].mean())

    def speed_mps(self, model: str) -> float:
        """Compute the mean speed, m/s, during the steps."""
        return float(self.length_m[model].sum()) / self.duration_s


def main() -> None:
    """Measure the recordings, and write results/uptime_table2.json and .txt and the table of the README."""
    document = as_document(list(measured(command_line(__doc__, {"--data": Path}).data)))
    write("uptime_table2", as_text(document), document)
    write_table(MARK, as_markdown(document))


def measured(data: Path) -> Iterable[Walk]:
    """Measure every recording of one of the `GROUPS`."""
    for file in gait.SUITE.find(data):
        activity = file.labels["activity"]
        if activity in GROUPS:
            (device,) = pipeline.analyse_recording(read(file.path), Config())
            duration_s = sum(step.event.time_s - step.start_s for step in device.steps)
            yield Walk(activity, duration_s, {model: lengths_m(device.steps, model) for model in MODELS})


def lengths_m(steps: Sequence[Step], model: str) -> Array:
    """Compute the length of each step, (n,) m, by a model with its default constants."""
    (name,) = [known for known in LENGTH_MODELS if known == model]
    config = Config()
    stage = StepLength(config.resample.rate_hz, config.walker, StepLengthParams(model=name))
    return np.array([sized.length_m for step in steps for sized in stage.push(step)])


def as_document(walks: Sequence[Walk]) -> list[Row]:
    """Make a row for each group: the length of the paper, and length and speed over the recordings by model."""
    document: list[Row] = []
    for activity, (words, paper) in GROUPS.items():
        own = [walk for walk in walks if walk.activity == activity]
        if not own:
            continue
        models = {
            model: {
                "length_m": spread([walk.mean_m(model) for walk in own]),
                "speed_mps": spread([walk.speed_mps(model) for walk in own]),
            }
            for model in MODELS
        }
        document.append({"what": words, "recordings": len(own), "paper_m": PAPER_M[paper], "models": models})
    return document


def spread(values: Sequence[float]) -> list[float]:
    """Return mean, least and greatest value."""
    return [round(float(value), 3) for value in (np.mean(values), min(values), max(values))]


def as_text(document: Sequence[Row]) -> str:
    """Format a line for each group."""
    lines = [
        "UPTIME Table II beside recordings without known lengths; per model the mean over the recordings, and from",
        "the least to the greatest: length of a step in m, speed in m/s.",
        "",
        f"{'':18}{'walks':>6}{'paper':>7}" + "".join(f"{model:>34}" for model in MODELS),
    ]
    for row in document:
        line = f"{row['what']:18}{row['recordings']:6d}{row['paper_m']:7.2f}"
        for model in MODELS:
            numbers = row["models"][model]
            line += "".join(f"{cell(numbers[name]):>17}" for name in ("length_m", "speed_mps"))
        lines.append(line)
    return "\n".join(lines) + "\n"


def as_markdown(document: Sequence[Row]) -> str:
    """Make the table of the README: lengths of the models, and the speed with `auto`."""
    headings = ("what", "recordings", "UPTIME m", *(f"`{model}` m" for model in MODELS), "`auto` m/s")
    rows = []
    for row in document:
        lengths = (cell(row["models"][model]["length_m"]) for model in MODELS)
        speed = cell(row["models"]["auto"]["speed_mps"])
        rows.append((row["what"], str(row["recordings"]), f"{row['paper_m']:.2f}", *lengths, speed))
    return markdown_table(headings, rows)


def cell(numbers: Sequence[float]) -> str:
    """Format the mean, and the least to the greatest value."""
    mean, least, greatest = numbers
    return f"{mean:.2f} ({least:.2f}–{greatest:.2f})"


if __name__ == "__main__":
    main()
