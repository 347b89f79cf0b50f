"""Calibration of a person's own step length from walks of known length or with position fixes.

* `step_length_fit`: Bayesian regression of the personal constants. `profile`: the file that keeps them.
"""
