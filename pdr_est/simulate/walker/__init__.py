"""The walker without any device: path, steps and moving trunk.

* `walking_path`: a polyline with rounded corners, parametrised by its arc length.
* `step_schedule`: times, lengths and feet of all steps.
* `gait_stretches`: stretches that are jogged, run, walked at another pace, or stairs.
* `step_curves`: curves of time through values at the steps.
* `running_bounce`: rise and fall of a runner, who leaves the ground in each step.
* `walking_body`: the motion of the trunk along the path, up and down, and from side to side.
"""
