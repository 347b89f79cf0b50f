"""Benchmark suites: many recorded walks with truth, scored in one table."""

from pdr_est.benchmark.result import BenchmarkResult
from pdr_est.benchmark.runner import run_benchmark
from pdr_est.benchmark.suites import SUITES
from pdr_est.benchmark.table import print_table
from pdr_est.benchmark.variant import compare

__all__ = ["SUITES", "BenchmarkResult", "compare", "print_table", "run_benchmark"]
