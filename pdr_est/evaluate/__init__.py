"""How good a track is: time association with the truth, alignment, error metrics, consistency of covariances."""
