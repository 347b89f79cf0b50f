"""Run the benchmark suites with all estimators, detectors, length models, headings or front ends.

Writes experiments/results/ and the table of the README and of docs/accuracy.md.

    python experiments/benchmark_tables.py --data DIR [--jobs 2] [--suite NAME ...]

DIR holds the data sets, laid out as `pdr-est benchmark` wants them. Without --suite all suites run.
"""

import argparse
import json
from pathlib import Path

from recorded import RESULTS, write_table
from rich.console import Console

from pdr_est.config import Config
from pdr_est.experiment import comparison_on_axis, print_benchmark, run_benchmark
from pdr_est.experiment.suites import SUITES
from pdr_est.experiment.variants.axes import axis_named
from pdr_est.output.atomic_output import text_output, write_text

PAGES = tuple(Path(__file__).parents[1] / page for page in ("README.md", "docs/accuracy.md"))
MARK = "<!-- benchmark -->"
# What the suites compare, one document for each. The others compare estimators only.
COMPARED = {
    "ilc20": ("estimator", "heading", "front-end"),
    "ipin2023": ("estimator", "front-end"),
    "oxiod": ("estimator", "heading", "front-end"),
    "phone-gps": ("estimator", "heading", "front-end"),
    "walks": ("front-end",),
    "oxford-steps": ("detector",),
    "weallwalk": ("estimator", "detector", "heading"),
    "known-distance": ("detector", "length-model"),
    "stride-length": ("length-model",),
    "motionsense": ("detector",),
    "gait": ("detector",),
}
ROWS = (
    ("ilc20", None, "Indoor Location Competition 2.0, malls, held"),
    ("ipin2023", None, "IPIN 2023, held"),
    ("oxiod", "large-scale/hand", "OxIOD, office loops, hand"),
    ("oxiod", "large-scale/pocket", "OxIOD, office loops, pocket"),
    ("oxiod", "large-scale/bag", "OxIOD, office loops, bag"),
    ("walks", "humolire", "humolire, corridors, held, heights known"),
    ("walks", "rfbr", "rfbr, held upright"),
    ("walks", "ridi", "RIDI, loops, hand, belt, bag and pocket"),
    ("walks", "oxiod-vicon", "OxIOD, other users in a small room"),
)


def main() -> None:
    """Write one JSON and one text table for each suite and what it compares."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    names = [suite.name for suite in SUITES]
    parser.add_argument("--suite", action="append", choices=names)
    options = parser.parse_args()
    for name in options.suite or names:
        first, *further = COMPARED.get(name, ("estimator",))
        record(name, first, options.data, options.jobs, name)
        for axis in further:
            record(name, axis, options.data, options.jobs, f"{name}-{axis}s")
    for page in PAGES:
        write_table(MARK, readme_table(), page)


def record(suite: str, compared: str, data: Path, jobs: int, stem: str) -> None:
    """Write the averages of a suite with all values of an axis, and its tables, to files of that stem."""
    axis = axis_named(compared)
    result = run_benchmark(suite, data, comparison_on_axis(Config(), axis.name, axis.values), jobs)
    summary = {key: value for key, value in result.to_dict().items() if key not in ("walks", "skipped")}
    write_text(RESULTS / f"{stem}.json", json.dumps(summary, indent=2) + "\n")
    with text_output(RESULTS / f"{stem}.txt") as stream:
        print_benchmark(result, Console(file=stream, width=160))


def readme_table() -> str:
    """Make the table of the README from the recorded results of the default estimator.

    A set stands in it, and so does the textbook chain, as soon as it is recorded.
    """
    recorded = [row for row in ROWS if (RESULTS / f"{row[0]}.json").is_file()]
    with_textbook = any(textbook_mean(suite, group) for suite, group, _ in recorded)
    headings = ["recordings", "walks", "ate_rigid_m median", "mean"]
    headings += ["textbook chain's mean"] if with_textbook else []
    headings += ["length_ratio median", "error_heldout_m", "coverage95", "`pdr-est benchmark`"]
    lines = [f"| {' | '.join(headings)} |", f"|{'---|' * len(headings)}"]
    for suite, group, words in recorded:
        result = json.loads((RESULTS / f"{suite}.json").read_text(encoding="utf-8"))
        metrics = result["summary"] if group is None else result["groups"][group]
        ate = metrics["ate_rigid_m"]
        cells = [f"{ate['median']:.2f}", f"{ate['mean']:.2f}"]
        cells += [textbook_mean(suite, group) or "–"] if with_textbook else []
        cells.append(f"{metrics['length_ratio']['median']:.3f}")
        for name in ("error_heldout_m", "coverage95"):
            cells.append(f"{metrics[name]['mean']:.2f}" if name in metrics else "–")
        lines.append(f"| {words} | {ate['n']} | {' | '.join(cells)} | `{suite}` |")
    return "\n".join(lines)


def textbook_mean(suite: str, group: str | None) -> str | None:
    """Return the mean `ate_rigid_m` of the textbook chain; None if it is not recorded."""
    path = RESULTS / (f"{suite}.json" if COMPARED[suite][0] == "front-end" else f"{suite}-front-ends.json")
    if not path.is_file():
        return None
    result = json.loads(path.read_text(encoding="utf-8"))
    means = result["front-ends"] if group is None else result["front-end_groups"]
    metrics = means["textbook"] if group is None else means["textbook"][group]
    return f"{metrics['ate_rigid_m']['mean']:.2f}"


if __name__ == "__main__":
    main()
