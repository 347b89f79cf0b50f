"""The turn of the walker while the phone is put elsewhere on the body.

* `turn_density`: probability densities of an angle on a grid around the circle, and hypotheses from them.
* `direction_cues`: the walking direction relative to the phone, from the motion of a few strides.
* `turn_estimate`: all that tells the turn, multiplied.
* `auto_params`: the parameters.
* `placement_tracker`: where the phone stays in one place and where it is put elsewhere.
"""
