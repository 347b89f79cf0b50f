"""Particle filter and smoother: the posterior of a walk where it is not Gaussian, such as on a floor plan."""
