"""Signal processing that the stages share, bit-identical however the signal is cut into blocks.

* `blocks`: join and cut blocks of samples.
* `filters`: causal Butterworth filters.
* `butterworth`: their coefficients.
* `recursion`: their output.
* `moving_average`: mean over a sliding window.
* `event_detection`: local extrema, Schmitt trigger and refractory period.
* `axis_turn`: axes that do not depend on how those of the device lie.
* `standing_bias`: the bias of the gyroscope while the walker stands.
* `vectors`: products of rows of vectors; specific force and its magnitude.
"""
