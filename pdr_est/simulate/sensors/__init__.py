"""Sensors of the simulated phones.

* `sensor_errors`: noise, bias, scale errors, clock errors, lost samples and gaps of a recorded signal.
* `magnetic_field`: the Earth's field and magnetised bodies beside the path.
* `compass_orientation`: the attitude that a phone without gyroscope reports.
"""
