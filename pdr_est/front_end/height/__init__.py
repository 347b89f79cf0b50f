"""Height of the walker and floors, by the air pressure.

* `height_params`: parameters.
* `seconds`: air pressure to heights, one for each second.
* `vertical_moves`: what stairs, escalators and lifts are like.
* `level_watch`: level or moving, second by second; `move_hypotheses` decides around changes of height.
* `path_of_modes`: what one hypothesis says.
* `vertical_filter`: what a second does to the Kalman filter of a hypothesis.
* `rise_smoothing`: heights under the decided modes.
* `storeys`: how many storeys a rise is; `floors`: the floor of each second.
* `profile`: all of it, for the recording of one device; `following`: second by second, while it is recorded.
"""

from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.profile import height_profile

__all__ = ["HeightParams", "height_profile"]
