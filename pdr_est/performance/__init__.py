"""Suite `speed`: CPU time and memory of the chain on simulated data, without recordings and without scores."""

from pdr_est.performance.run import LENGTHS_MIN, NAME, SpeedResult, run_speed
from pdr_est.performance.table import print_speed

__all__ = ["LENGTHS_MIN", "NAME", "SpeedResult", "print_speed", "run_speed"]
