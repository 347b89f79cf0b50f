"""Calibration of a person's own step length from walks of known length or with position fixes.

* `step_length_fit`: Bayesian regression of the personal constants on what walks show.
* `scale_by_fixes`: the length scale that one walk shows by its fixes.
* `profile`: the walks of a walker and the constants that follow from them; `profile_file`: its file.
* `learning`: a profile learns a walk.
"""
