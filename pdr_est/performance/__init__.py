"""The suite `speed`: what the chain costs on simulated data. It needs no recordings and scores no walks."""

from pdr_est.performance.run import LENGTHS_MIN, NAME, SpeedResult, run_speed
from pdr_est.performance.table import print_speed

__all__ = ["LENGTHS_MIN", "NAME", "SpeedResult", "print_speed", "run_speed"]
