"""Table III of UPTIME (Alzantot and Youssef 2012) on real phones: the step FSM against its two baselines.

    python experiments/uptime_table3.py --data DIR

DIR holds the data sets, laid out as `pdr-est benchmark` wants them; used are the Oxford step-counting recordings.
Prints the table and writes it to experiments/results/ and experiments/README.md.
"""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from recorded import write, write_table

from pdr_est.config import Config
from pdr_est.experiment import BenchmarkResult, comparison_on_axis, run_benchmark

MARK = "<!-- uptime table 3 -->"
DETECTORS = ("uptime-fsm", "local-variance", "zero-crossing", "auto")

Table = dict[str, dict[str, float]]


@dataclass(frozen=True)
class Place:
    """Where a phone was. positions: those of the data set, none means all. paper_percent: the paper's errors."""

    words: str
    positions: tuple[str, ...]
    paper_percent: dict[str, float]


PLACES = (
    Place("in hand", ("InHand",), {"uptime-fsm": 2.66, "local-variance": 27.18, "zero-crossing": 30.19}),
    Place(
        "in pocket",
        ("FrontPocket", "BackPocket"),
        {"uptime-fsm": 9.29, "local-variance": 44.27, "zero-crossing": 34.07},
    ),
    Place(
        "hand and pocket",
        ("InHand", "FrontPocket", "BackPocket"),
        {"uptime-fsm": 5.72, "local-variance": 35.08, "zero-crossing": 31.98},
    ),
    Place("all positions", (), {}),
)


def main() -> None:
    """Run the detectors on the recordings and write results/uptime_table3.json and .txt and the README's table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    comparison = comparison_on_axis(Config(), "detector", DETECTORS)
    table = measured(run_benchmark("oxford-steps", options.data, comparison, options.jobs))
    write("uptime_table3", as_text(table), as_document(table))
    write_table(MARK, as_markdown(table))


def measured(result: BenchmarkResult) -> Table:
    """Mean count error in percent to three places, by place and detector; "walks" is how many are behind it."""
    return {
        place.words: {
            "walks": float(len(_errors(result, place, DETECTORS[0]))),
            **{name: round(100.0 * float(np.mean(_errors(result, place, name))), 3) for name in DETECTORS},
        }
        for place in PLACES
    }


def as_document(table: Table) -> dict[str, dict[str, dict[str, float]]]:
    """Paper and measurement side by side, in percent."""
    return {
        place.words: {"paper_percent": place.paper_percent, "measured_percent": table[place.words]}
        for place in PLACES
    }


def as_text(table: Table) -> str:
    """One line a place, one pair of columns a detector: the paper's number and ours."""
    lines = [
        "Mean error of the number of steps, in percent: UPTIME's Table III, and ours on the Oxford recordings.",
        "",
        f"{'':16}{'walks':>6}" + "".join(f"{name:>20}" for name in DETECTORS),
        f"{'':22}" + f"{'paper':>12}{'ours':>8}" * len(DETECTORS),
    ]
    for place in PLACES:
        cells = table[place.words]
        line = f"{place.words:16}{cells['walks']:6.0f}"
        for name in DETECTORS:
            paper = place.paper_percent.get(name)
            line += f"{'-' if paper is None else f'{paper:.2f}':>12}{cells[name]:8.2f}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def as_markdown(table: Table) -> str:
    """The README's table: the paper's number / ours."""
    heads = " | ".join(f"`{name}`" for name in DETECTORS)
    lines = [f"| phone | walks | {heads} |", "|---" * (len(DETECTORS) + 2) + "|"]
    for place in PLACES:
        cells = table[place.words]
        paper = {name: f"{percent:.2f}" for name, percent in place.paper_percent.items()}
        pairs = " | ".join(f"{paper.get(name, '–')} / {cells[name]:.2f}" for name in DETECTORS)
        lines.append(f"| {place.words} | {cells['walks']:.0f} | {pairs} |")
    return "\n".join(lines)


def _errors(result: BenchmarkResult, place: Place, detector: str) -> Sequence[float]:
    """Count errors of the walks with the phone in a place."""
    rows = [row for row in result.rows if row.variant == detector]
    if place.positions:
        rows = [row for row in rows if row.labels["position"] in place.positions]
    return [error for row in rows if (error := row.metrics["count_error"]) is not None]


if __name__ == "__main__":
    main()
