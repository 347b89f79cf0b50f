"""Tests that every stage and every estimator has to pass, also one from outside the package.

They raise AssertionError with what is wrong, and need no test framework:

    from pdr_est.testing import check_estimator, check_partition, check_stage, stage_inputs

    check_stage(MyDetector, stage_inputs("level"))
    check_partition(MyDetector, stage_inputs("level"))
    check_estimator(MyEstimator())

* `stage_checks`: the contract of a stage, and its bit-identical outputs for every way of cutting the input.
* `estimator_checks`: the contract of an estimator, offline and online.
* `partitions`: ways of cutting a recording, and the exact content of outputs.
* `messy_recordings`: inputs with all faults that recorders have.
"""

from pdr_est.testing.estimator_checks import check_estimator
from pdr_est.testing.messy_recordings import messy_device, stage_inputs
from pdr_est.testing.partitions import (
    Block,
    cut_block,
    cut_finely,
    cut_randomly,
    exact_content,
    in_bursts,
    in_time_order,
    interleave,
    one_by_one,
    run_stage,
    slice_block,
)
from pdr_est.testing.stage_checks import check_partition, check_stage

__all__ = [
    "Block",
    "check_estimator",
    "check_partition",
    "check_stage",
    "cut_block",
    "cut_finely",
    "cut_randomly",
    "exact_content",
    "in_bursts",
    "in_time_order",
    "interleave",
    "messy_device",
    "one_by_one",
    "run_stage",
    "slice_block",
    "stage_inputs",
]
