"""Alternatives of a walk that its measurements leave open, for estimators that smooth.

Where one linearisation cannot know, the bank of hypotheses of the Kalman filter weighs what is possible, by all
measurements of the walk: the turn of a walker whose phone was put elsewhere on the way, and a start heading that
nobody gave. A smoother then works on one alternative at a time, and the tracks are put together as a mixture.

* `alternative`: the record of one alternative.
* `device_courses`, `chosen_turns`: the alternatives of one device, and the turns that each of them has.
* `walk_alternatives`: those of all devices together.
* `mixture`: the track of the most probable one, with the covariance of all.
"""

from pdr_est.estimators.alternatives.alternative import Alternative
from pdr_est.estimators.alternatives.mixture import estimate_alternatives
from pdr_est.estimators.alternatives.walk_alternatives import alternatives_of

__all__ = ["Alternative", "alternatives_of", "estimate_alternatives"]
