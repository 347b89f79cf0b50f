"""Find the unit of axes that state none, or an unknown one, where other axes of the same sensor state theirs."""

from collections.abc import Sequence

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.units import Conversion
from pdr_est.io.tables.mapping import QuantityColumns
from pdr_est.io.tables.quantities import MOTION, Quantity, known_units, usual_unit

_GRAVITY_LOG_SIGMA = 0.1  # of the length of the mean; a walk's is within 10 % of gravity
# Of the ratio of the motion along one axis to that along the others: the logarithm has a standard deviation of 0.5
# over 74 recordings of eleven data sets, but of 1.1 in one of them.
_MOTION_LOG_SIGMA = 1.0
# The axes of one sensor mostly have one unit, and where a title states none it is m/s^2 or rad/s more often than
# another: odds of 3 and of 150 to 1, and of 1000 to 1 for units such as mrad/s, a judgement. As squares in standard
# deviations.
_OTHER_UNIT_IN_SI, _OTHER_UNIT, _RARE_UNIT = 2.5, 10.0, 14.0
_DECISIVE = 6.0


def complete_factors(values: Array, columns: QuantityColumns, quantity: Quantity) -> tuple[Array, Conversion | None]:
    """Return the factor (k,) of each column to SI units, where at least one column states its unit.

    Columns without a unit are taken to share one: that of the other axes, unless another one fits much better, with
    which all axes move about as much and the mean of an accelerometer is as long as gravity.

    Parameters
    ----------
    values
        (n, k) as recorded.
    columns
        Columns with their stated factors.
    quantity
        What they measure.

    Returns
    -------
    factors : (k,)
    conversion : Conversion or None
        How the unit of the others was found; None where all columns state theirs.
    """
    stated = [factor for factor in columns.factors if factor is not None]
    unknown = [i for i, factor in enumerate(columns.factors) if factor is None]
    factors = np.array([np.nan if factor is None else factor for factor in columns.factors])
    titles = ", ".join(columns.titles[i] for i in unknown)
    if not unknown:
        return factors, None
    if quantity not in (*MOTION, Quantity.GRAVITY):
        factors[unknown] = stated[0]
        return factors, Conversion(1.0, f"{titles}: taken in the unit of the other axes")
    finite = values[np.isfinite(values).all(axis=1)]
    names = {factor: name for name, factor in known_units(quantity).items()}
    costs = {
        factor: _cost(finite, factors, unknown, factor, quantity)
        + _prior_cost(factor, stated, usual_unit(quantity, factor) is not None)
        for factor in names
    }
    best, second, *_ = sorted(costs, key=costs.__getitem__)
    factors[unknown] = best
    decision = f"{titles}: in {names[best]}, by comparison with the axes that state their unit"
    if costs[second] - costs[best] >= _DECISIVE:
        return factors, Conversion(1.0, decision)
    return factors, Conversion(
        1.0,
        decision,
        f"the unit of {titles} is not certain: {names[best]} is taken, {names[second]} fits as well; write it into "
        "the header",
    )


def unknown_unit_words(columns: QuantityColumns) -> str:
    """Name the units in titles that are not known, for a message; "" where there are none."""
    found = [(title, unit) for title, unit in zip(columns.titles, columns.unknown_units, strict=False) if unit]
    if not found:
        return ""
    units = ", ".join(dict.fromkeys(repr(unit) for _, unit in found))
    return f"the unit {units} of {', '.join(title for title, _ in found)} is not known"


def _prior_cost(factor: float, stated: Sequence[float], usual: bool) -> float:
    if factor in stated:
        return 0.0
    if not usual:
        return _RARE_UNIT
    return _OTHER_UNIT_IN_SI if factor == 1.0 else _OTHER_UNIT


def _cost(values: Array, factors: Array, unknown: Sequence[int], factor: float, quantity: Quantity) -> float:
    """Compute how badly a unit of the unknown axes fits: squares in standard deviations."""
    if not len(values):
        return 0.0
    tried = np.where(np.isnan(factors), factor, factors)
    scaled = values * tried
    spread = np.maximum(scaled.std(axis=0), 1e-9)
    known = [i for i in range(len(factors)) if i not in unknown]
    ratio = np.log(np.mean(spread[list(unknown)]) / np.mean(spread[known]))
    cost = (ratio / _MOTION_LOG_SIGMA) ** 2
    if quantity is Quantity.FORCE:
        mean = max(float(np.linalg.norm(scaled.mean(axis=0))), 1e-9)
        cost += (np.log(mean / STANDARD_GRAVITY_MPS2) / _GRAVITY_LOG_SIGMA) ** 2
    return float(cost)
