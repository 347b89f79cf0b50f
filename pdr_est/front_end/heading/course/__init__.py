"""Find the stretches in which a walker moves sideways or backwards.

* `course_params`: the parameters.
* `leading_acceleration`: what the acceleration of each step tells of the direction in which the walker moves.
* `running`: the steps of runners, which tell it otherwise.
* `sideways_chain`: the probabilities of all angles between that direction and the body, step by step.
* `course_likelihood`: how likely an acceleration is for each angle, and how often people move so.
* `online_course`: the same chain forward only, at the step.
* `course_offsets`: at the end of a walk: where to look for such stretches, and the steps with their directions.
"""
