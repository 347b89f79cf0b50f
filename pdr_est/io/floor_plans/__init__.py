"""Read floor plans: GeoJSON, the maps of the Indoor Location Competition 2.0, and pictures with two known points.

`pdr_est.io.floor_plans.reading` finds out which it is. The geometry needs shapely and the pictures scikit-image, both
of the extra `map`, and only this folder knows them.
"""
