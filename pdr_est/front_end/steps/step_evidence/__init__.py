"""Find out for the default step detector whether a peak is a step, and whether somebody walks at all.

* `step_signal`: the signal that has one peak per step.
* `step_probability`: the probability that a peak is a step, from its rise and from the rhythm.
* `movement`: how the phone moved in any span, from running sums.
* `walking_belief`: the probability that the phone's carrier walks, from its movement and the rhythm of peaks.
* `step_intervals`: the rhythm, and the steps that did not show.
"""
