"""Randomly drawn walkers, with gait and ways of carrying a phone that differ as between real people.

* `person`: one walker. `carried_device`: a phone that this walker carries in given modes.
* `population`: many walks of many walkers.
"""
