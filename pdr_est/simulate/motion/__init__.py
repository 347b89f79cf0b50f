"""Exactly differentiable motion: everything that moves is a function of time with analytic derivatives.

* `differentiable_signal`: a scalar signal with its first and second time derivative, and the arithmetic on it.
* `attitude_signal`: an orientation over time as a unit quaternion of such signals; its rotation rate is exact.
* `rigid_body`: position and orientation of a device, and the readings of ideal inertial sensors fixed to it.
* `random_signals`: random but smooth motion (sums of sinusoids) of hands, legs and posture.
"""
