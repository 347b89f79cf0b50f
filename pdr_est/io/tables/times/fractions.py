"""Read the digits behind the seconds: a decimal fraction, or a count of ms, us or ns without zeros in front."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

_COUNTED = {3: "ms", 6: "us", 9: "ns"}
_SMOOTHER = 0.9  # ours: of the way that the times go as decimals; with zeros lost they go to and fro every second


@dataclass(frozen=True)
class Fractions:
    """Fractions of a second.

    Attributes
    ----------
    ns
        (n,) int64 ns.
    counted
        "ms", "us" or "ns" where the digits count these, so that `.9` is 9 ms; "" for decimal fractions.
    """

    ns: NDArray[Any]
    counted: str = ""


def read_fractions(digits: pl.Series, seconds: NDArray[Any], known: NDArray[np.bool_]) -> Fractions:
    """Read the digits behind the seconds of all rows.

    Digits of varying number are a decimal fraction without zeros at its end, or a count without zeros in front. That
    is the right one with which time goes the shorter way.

    Parameters
    ----------
    digits
        (n,) digits as text; null where a row has none.
    seconds
        (n,) whole seconds, to which the fractions are added.
    known
        (n,) False for rows that are no times.
    """
    digits = digits.fill_null("0")
    decimal = digits.str.pad_end(9, "0").cast(pl.Int64).to_numpy()
    lengths = digits.str.len_chars().to_numpy()[known]
    if not len(lengths) or lengths.min() == lengths.max():
        return Fractions(decimal)
    places, unit = next((places, unit) for places, unit in _COUNTED.items() if lengths.max() <= places)
    counted = digits.cast(pl.Int64).to_numpy() * 10 ** (9 - places)
    if _way(counted, seconds, known) < _SMOOTHER * _way(decimal, seconds, known):
        return Fractions(counted, unit)
    return Fractions(decimal)


def _way(fraction_ns: NDArray[Any], seconds: NDArray[Any], known: NDArray[np.bool_]) -> float:
    """Compute how far the times go to and fro in all, s."""
    return float(np.abs(np.diff(seconds[known] + fraction_ns[known] / 1e9)).sum())
