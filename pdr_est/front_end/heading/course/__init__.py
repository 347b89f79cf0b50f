"""Find the stretches in which a walker moves sideways or backwards.

* `course_params`: the parameters.
* `leading_acceleration`: what the acceleration of each step tells of the direction in which the walker moves.
* `sideways_chain`: the probabilities of all angles between that direction and the body, step by step.
* `course_offsets`: where to look for such stretches, and the steps with their directions.
"""
