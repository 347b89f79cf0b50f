"""Find the unit of axes that state none, where other axes of the same sensor do."""

from collections.abc import Sequence

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.units import Conversion
from pdr_est.io.tables.mapping import QuantityColumns
from pdr_est.io.tables.quantities import MOTION, USUAL_UNITS, Quantity

_GRAVITY_LOG_SIGMA = 0.1  # of the length of the mean; a walk's is within 10 % of gravity
_MOTION_LOG_SIGMA = 1.0  # of the ratio of the motion along two axes of one sensor
_DECISIVE = 6.0


def complete_factors(values: Array, columns: QuantityColumns, quantity: Quantity) -> tuple[Array, Conversion | None]:
    """Return the factor (k,) of each column to SI units, where at least one column states its unit.

    Columns without a unit are taken to share one: that with which all axes move about as much, and in which the mean
    of an accelerometer is as long as gravity.

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
    usual = USUAL_UNITS[quantity]
    costs = {unit: _cost(finite, factors, unknown, factor, quantity) for unit, factor in usual.items()}
    best, second, *_ = sorted(costs, key=costs.__getitem__)
    factors[unknown] = usual[best]
    decision = f"{titles}: in {best}, by comparison with the axes that state their unit"
    close = costs[second] - costs[best] < _DECISIVE
    warning = f"the unit of {titles} is not certain: {best} is taken, {second} fits as well; write it into the header"
    return factors, Conversion(1.0, decision, warning if close else "")


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
