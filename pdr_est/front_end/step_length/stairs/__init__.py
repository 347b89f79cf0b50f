"""Find the steps on stairs, by the vertical motion of the whole walk, and give them the length of a tread.

* `stair_params`: parameters.
* `vertical_motion`: mean vertical velocity and height of each step.
* `flight_hypotheses`: probability of every step to lie on a flight, by a bank of Kalman filters.
* `velocity_changes`: what the beginning and the end of a flight look like.
* `walk_noise`: noise of the walk that these are judged against.
* `flight_watch`: the steps for which the hypotheses are compared.
* `stair_lengths`: the stage.
"""

from pdr_est.front_end.step_length.stairs.stair_lengths import StairLengths
from pdr_est.front_end.step_length.stairs.stair_params import StairParams

__all__ = ["StairLengths", "StairParams"]
