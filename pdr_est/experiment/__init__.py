"""Experiments and benchmarks: walks, variants of the settings, scoring, and tables of the results.

An experiment is described by a file and compares variants on recorded or simulated walks. A benchmark is a fixed
suite of recorded walks of a public data set. Both score walks by the same job and keep the same result rows.
"""

from pdr_est.experiment.loader import Experiment, load_experiment
from pdr_est.experiment.results.benchmark_result import BenchmarkResult
from pdr_est.experiment.results.console_tables import print_benchmark
from pdr_est.experiment.runners.benchmark_run import run_benchmark
from pdr_est.experiment.runners.experiment_run import run_experiment
from pdr_est.experiment.suites import SUITES
from pdr_est.experiment.variants.axes import comparison_on_axis

__all__ = [
    "SUITES",
    "BenchmarkResult",
    "Experiment",
    "comparison_on_axis",
    "load_experiment",
    "print_benchmark",
    "run_benchmark",
    "run_experiment",
]
