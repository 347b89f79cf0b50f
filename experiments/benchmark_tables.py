"""Runs every benchmark suite with every estimator and writes the tables into experiments/results/.

    python experiments/benchmark_tables.py --data DIR [--jobs 2]

DIR holds the data sets, laid out as `pdr-est benchmark` wants them.
"""

import argparse
import json
from pathlib import Path

from rich.console import Console

from pdr_est.benchmark.runner import run_benchmark
from pdr_est.benchmark.suites import SUITES
from pdr_est.benchmark.table import print_table
from pdr_est.config import Config
from pdr_est.estimators import ESTIMATORS

RESULTS = Path(__file__).parent / "results"


def main() -> None:
    """Write one JSON and one text table a suite."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    for suite in SUITES:
        result = run_benchmark(suite.name, options.data, Config(), ESTIMATORS, options.jobs)
        summary = {key: value for key, value in result.to_dict().items() if key not in ("walks", "skipped")}
        (RESULTS / f"{suite.name}.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
        with (RESULTS / f"{suite.name}.txt").open("w", encoding="utf-8") as stream:
            print_table(result, Console(file=stream, width=160))


if __name__ == "__main__":
    main()
