"""Parameters of the search for sideways and backward walking."""

from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.params import Positive, params


@params
class CourseParams:
    """Parameters of the search for stretches in which the walker moves sideways or backwards; all values are ours."""

    enabled: bool = True
    """True to look for such stretches, at the step and again at the end of the walk, for the method "auto"."""
    correlated_steps: Annotated[float, Ge(1.0), Le(100.0)] = 3.0
    """Number of neighbouring steps whose accelerations count as one observation, because their errors are alike.
    Measured: the correlation time of the errors of people who walk ahead has a median of 2.8 to 6.4 steps on four
    data sets (IPIN 2023, phones on playing fields, OxIOD, ILC20).
    """
    least_clearness: Positive = 1.5
    """Least ratio of the mean forward acceleration of the steps to its standard deviation in one direction; below,
    a single step does not tell its direction (phones in bags and in swinging hands).
    """
    least_log_likelihood_ratio: Positive = 3.5
    """Logarithm of the likelihood ratio of moving straight on while the phone turned, against turning with the phone,
    from which on a stretch is searched. People mostly turn with the phone: such a stretch begins at one step of 400
    by the prior probabilities, so that less leaves a probability below a tenth.
    """
