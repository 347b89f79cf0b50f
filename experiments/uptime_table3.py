"""Table III of UPTIME (Alzantot and Youssef 2012) on real phones: the step FSM against its two baselines.

    python experiments/uptime_table3.py --data DIR

DIR holds the data sets, laid out as `pdr-est benchmark` wants them; used are the Oxford step-counting recordings. The
paper put its two baselines, made for a sensor on the foot, on the phone without suiting them to it. They are here in
both ways: with our defaults, which suit a phone, and untuned. Untuned, `local-variance` has the window and thresholds
that public programs of the method have for the foot (we do not have the text of the paper's reference [10]), no
filter to speak of and no least time between steps; `zero-crossing` has neither a dead band nor a least time. Prints
the table and writes it to experiments/results/ and experiments/paper-details.md.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from recorded import command_line, markdown_table, write, write_table

from pdr_est.config import Config
from pdr_est.experiment import BenchmarkResult, run_benchmark
from pdr_est.experiment.variants.axes import Comparison, Variant
from pdr_est.front_end.steps import StepsParams
from pdr_est.front_end.steps.local_variance import LocalVarianceParams
from pdr_est.front_end.steps.zero_crossing import ZeroCrossingParams

MARK = "<!-- uptime table 3 -->"
FOOT_WINDOW_S, FOOT_SWING_MPS2, FOOT_STANCE_MPS2 = 0.31, 2.0, 1.0  # 31 samples at 100 Hz
UNTUNED = {
    "local-variance, untuned": StepsParams(
        detector="local-variance",
        local_variance=LocalVarianceParams(
            cutoff_hz=20.0,
            window_s=FOOT_WINDOW_S,
            swing_mps2=FOOT_SWING_MPS2,
            stance_mps2=FOOT_STANCE_MPS2,
            min_interval_s=0.0,
        ),
    ),
    "zero-crossing, untuned": StepsParams(
        detector="zero-crossing", zero_crossing=ZeroCrossingParams(dead_band_mps2=0.0, min_interval_s=0.0)
    ),
}
TUNED = ("uptime-fsm", "local-variance", "zero-crossing", "auto")
DETECTORS: Mapping[str, StepsParams] = {
    "uptime-fsm": StepsParams(detector="uptime-fsm"),
    **UNTUNED,
    **{name: StepsParams(detector=name) for name in TUNED[1:]},
}
"""Detectors by name, those of the paper first."""

Table = dict[str, dict[str, float]]


@dataclass(frozen=True)
class Place:
    """Place of a phone: its positions in the data set (none means all), and the errors of the paper."""

    words: str
    positions: tuple[str, ...]
    paper_percent: dict[str, float]


def paper_percent(*percent: float) -> dict[str, float]:
    """Name the errors of the paper by the detectors that stand for its three."""
    return dict(zip(("uptime-fsm", *UNTUNED), percent, strict=True))


PLACES = (
    Place("in hand", ("InHand",), paper_percent(2.66, 27.18, 30.19)),
    Place("in pocket", ("FrontPocket", "BackPocket"), paper_percent(9.29, 44.27, 34.07)),
    Place("hand and pocket", ("InHand", "FrontPocket", "BackPocket"), paper_percent(5.72, 35.08, 31.98)),
    Place("all positions", (), {}),
)


def main() -> None:
    """Run the detectors on the recordings, and write results/uptime_table3.json and .txt and the README's table."""
    options = command_line(__doc__, {"--data": Path, "--jobs": 1})
    table = measured(benchmark(options.data, options.jobs))
    write("uptime_table3", as_text(table), as_document(table))
    write_table(MARK, as_markdown(table))


def benchmark(data: Path, jobs: int = 1) -> BenchmarkResult:
    """Run all detectors on the recordings."""
    variants = tuple(Variant(name, replace(Config(), steps=steps)) for name, steps in DETECTORS.items())
    return run_benchmark("oxford-steps", data, Comparison("detector", variants, variants[-1]), jobs)


def measured(result: BenchmarkResult) -> Table:
    """Compute the mean count error, percent, by place and detector, and the number of walks."""
    return {
        place.words: {
            "walks": float(len(_errors(result, place, "auto"))),
            **{name: round(100.0 * float(np.mean(_errors(result, place, name))), 3) for name in DETECTORS},
        }
        for place in PLACES
    }


def as_document(table: Table) -> dict[str, dict[str, dict[str, float]]]:
    """Make the document: paper and measurement side by side, in percent."""
    return {
        place.words: {"paper_percent": place.paper_percent, "measured_percent": table[place.words]}
        for place in PLACES
    }


def as_text(table: Table) -> str:
    """Format a line for each place, with the numbers of the paper and ours for each detector."""
    lines = [
        "Mean error of the number of steps, in percent: UPTIME's Table III, and ours on the Oxford recordings.",
        "",
        f"{'':16}{'walks':>6}" + "".join(f"{name:>26}" for name in DETECTORS),
        f"{'':22}" + f"{'paper':>18}{'ours':>8}" * len(DETECTORS),
    ]
    for place in PLACES:
        cells = table[place.words]
        line = f"{place.words:16}{cells['walks']:6.0f}"
        for name in DETECTORS:
            paper = place.paper_percent.get(name)
            line += f"{'-' if paper is None else f'{paper:.2f}':>18}{cells[name]:8.2f}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def as_markdown(table: Table) -> str:
    """Make the table of the README: the number of the paper / ours."""
    rows = []
    for place in PLACES:
        cells = table[place.words]
        paper = {name: f"{percent:.2f}" for name, percent in place.paper_percent.items()}
        pairs = (f"{paper.get(name, '–')} / {cells[name]:.2f}" for name in DETECTORS)
        rows.append((place.words, f"{cells['walks']:.0f}", *pairs))
    heads = (f"`{name}`" if name not in UNTUNED else f"`{name.partition(',')[0]}` untuned" for name in DETECTORS)
    return markdown_table(("phone", "walks", *heads), rows)


def _errors(result: BenchmarkResult, place: Place, detector: str) -> Sequence[float]:
    """Return the count errors of the walks with the phone in a place."""
    rows = [row for row in result.rows if row.variant == detector]
    if place.positions:
        rows = [row for row in rows if row.labels["position"] in place.positions]
    return [error for row in rows if (error := row.metrics["count_error"]) is not None]


if __name__ == "__main__":
    main()
