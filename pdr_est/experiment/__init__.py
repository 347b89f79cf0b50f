"""Experiments: one file describes walks and variants; running it gives a table, a report and all to repeat it."""

from pdr_est.experiment.load import Experiment, load_experiment
from pdr_est.experiment.runner import run_experiment

__all__ = ["Experiment", "load_experiment", "run_experiment"]
