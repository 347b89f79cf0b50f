"""Length of a step that may be of either of two kinds."""

import math


def mixture_mean_and_sigma(
    share: float, first: tuple[float, float], second: tuple[float, float]
) -> tuple[float, float]:
    """Compute mean and standard deviation of a mixture of two distributions.

    Parameters
    ----------
    share : float
        Weight of the second distribution.
    first, second : tuple of float
        Mean and standard deviation of each. Where the weight lies in between, the difference of the means adds to the
        result.
    """
    mean = (1.0 - share) * first[0] + share * second[0]
    between = share * (1.0 - share) * (second[0] - first[0]) ** 2
    return mean, math.sqrt((1.0 - share) * first[1] ** 2 + share * second[1] ** 2 + between)
