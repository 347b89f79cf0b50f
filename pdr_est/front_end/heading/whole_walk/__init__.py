"""Heading corrections that need the whole walk: turns while the phone was put elsewhere, and dominant directions.

* `placement_turns`: the turns while the phone was put elsewhere, from all strides in each place.
* `later_standing`: the bias of the gyroscope by standing later in the walk.
* `straight_legs`: the straight legs of the walk, in sections of a few steps.
* `dominant_directions`: the most probable dominant directions, and the drift of the headings against them.
* `wall_directions`: the directions of the walls on a floor plan.
* `offset_evidence`: what these directions tell about such a turn.
* `constant_rate`: candidates for the rate of the drift by a biased gyroscope.
* `drift_model`: levels of that drift, and how much of it lies between two sections.
* `collapsed_passes`: an approximate comparison of all drifts and numbers of directions, which tells the likely ones.
* `drift_passes`: the forward and the backward pass over that drift.
* `circular_grid`: probability densities of an angle.
* `drift_correction`: the stage that corrects the headings by both, or hands the directions on as heading priors.
"""
