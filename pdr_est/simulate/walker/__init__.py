"""The walker without any device: path, steps and moving trunk.

* `walking_path`: a polyline with rounded corners, parametrised by its arc length.
* `step_schedule`: times, lengths and feet of all steps.
* `walking_body`: the motion of the trunk along the path, up and down, and from side to side.
"""
