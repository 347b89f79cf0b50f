"""Probabilities of the normal distribution."""

from pdr_est.frames import Array


def normal_cdf(value: Array) -> Array:
    """Return the probability that a standard normal number is below a value, of any shape.

    scipy is imported at use: commands that only look at a recording start without it.
    """
    from scipy.special import ndtr

    probability: Array = ndtr(value)
    return probability
