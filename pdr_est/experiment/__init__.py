"""Experiments: one file describes walks and variants; running it gives a table, a report and all to repeat it."""

from pdr_est.experiment.loader import Experiment, load_experiment
from pdr_est.experiment.results.console_table import print_table
from pdr_est.experiment.results.score_rows import BenchmarkResult
from pdr_est.experiment.runner import run_experiment
from pdr_est.experiment.runners.score_walk import run_benchmark
from pdr_est.experiment.suites import SUITES
from pdr_est.experiment.variants.axes import compare

__all__ = ["Experiment", "load_experiment", "run_experiment"]


__all__ = ["SUITES", "BenchmarkResult", "compare", "print_table", "run_benchmark"]
