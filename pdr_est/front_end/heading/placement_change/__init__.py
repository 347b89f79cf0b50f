"""The turn of the walker while the phone is put elsewhere on the body.

* `turn_density`: probability densities of an angle on a grid around the circle, and hypotheses from them.
* `stride_cues`: the motion of a stride, as the phone felt it.
* `limb_swing`: the walking direction relative to a phone on a leg or an arm, from the rotation of the limb.
* `direction_cues`: the walking direction relative to the phone, from all that a few strides tell.
* `turn_estimate`: all that tells the turn, multiplied.
* `auto_params`: the parameters.
* `placement_tracker`: where the phone stays in one place and where it is put elsewhere.
"""
