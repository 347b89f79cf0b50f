"""Benchmark suites: many recorded walks with truth, scored in one table."""

from pdr_est.benchmark.result import BenchmarkResult
from pdr_est.benchmark.runner import run_benchmark
from pdr_est.benchmark.suites import SUITES
from pdr_est.benchmark.table import print_table

__all__ = ["SUITES", "BenchmarkResult", "print_table", "run_benchmark"]
