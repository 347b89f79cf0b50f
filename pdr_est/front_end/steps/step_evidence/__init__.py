"""Find out for the default step detector whether a peak is a step, and whether somebody walks at all.

* `step_signal`: the signal that has one peak per step.
* `step_probability`: the probability that a peak is a step, from its rise and from the rhythm.
* `movement`: how the phone moved in any span, from running sums.
* `peak_measurements`: what is known of a peak before anything is decided about it.
* `stride_likeness`: how alike the strides are sideways and lengthways, which tells walkers from passengers.
* `walking_belief`: the probability that the phone's carrier walks, from its movement, the rhythm of peaks and the
  likeness of strides.
* `step_intervals`: the rhythm, and the steps that did not show.
"""
