"""Headings against north, from the attitude that the device computed or from its magnetometer.

* `params`: choice of the source, and the standard deviations.
* `declination`: the angle from true to magnetic north at a place.
* `reference`: what is known of north for one device.
* `north_offset`: north in the level frame of the phone.
* `usual_azimuth`: the direction that a phone in front of the body points to by the usual axes of phones.
* `pointing`: the direction that the walker goes, relative to a phone in the hand.
* `correlated_error`: standard deviations of measurements whose errors are alike.
* `north_priors`: the stage that makes heading priors.
"""

from pdr_est.front_end.heading.north.north_priors import NorthPriors
from pdr_est.front_end.heading.north.params import NorthParams
from pdr_est.front_end.heading.north.reference import NorthReference, north_reference

__all__ = ["NorthParams", "NorthPriors", "NorthReference", "north_reference"]
