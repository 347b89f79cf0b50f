"""Turn the samples of one device into measurements for the estimators.

The front end knows phones and gait and nothing of estimators. Its stages, in the order in which they run:

* `attitude`: direction of gravity, vertical acceleration and yaw of every sample.
* `mode`: carrying mode of every sample (held, swinging, in a pocket, elsewhere on the body).
* `steps`: step detectors, and the cut of the samples into steps.
* `gait`: walking, jogging or running, by support-vector machines.
* `step_length`: length of each step and its standard deviation.
* `heading`: walking direction of each step.
* `odometry`: step odometry and heading priors with their noise, which is set nowhere else.

`signal` holds the filters, averages and event detectors that the stages share.
"""
