"""Headings against north, from the attitude that the device computed or from its magnetometer.

* `params`: choice of the source, and the standard deviations.
* `declination`: the angle from true to magnetic north at a place.
* `reference`: what is known of north for one device.
* `walker_azimuth`: the direction that a phone in the hand points to.
* `correlated_error`: standard deviations of measurements whose errors are alike.
* `north_priors`: the stage that makes heading priors.
"""

from pdr_est.front_end.heading.north.north_priors import NorthPriors
from pdr_est.front_end.heading.north.params import NorthParams
from pdr_est.front_end.heading.north.reference import NorthReference, north_reference

__all__ = ["NorthParams", "NorthPriors", "NorthReference", "north_reference"]
