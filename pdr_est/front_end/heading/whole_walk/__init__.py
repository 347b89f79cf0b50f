"""Heading corrections that need the whole walk: the dominant directions of the building.

* `straight_legs`: the straight legs of the walk, in sections of a few steps.
* `dominant_directions`: the most probable dominant directions, and the drift of the headings against them.
* `circular_grid`: probability densities of an angle.
* `drift_correction`: the stage that corrects the headings, or hands the directions on as heading priors.
"""
