"""Wandering errors of position fixes in the window of the fixed-lag smoother."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

import gtsam

from pdr_est.estimators.common.motion_model import SourceState
from pdr_est.estimators.common.timeline import Node
from pdr_est.estimators.common.wandering_error import wander_to
from pdr_est.estimators.factor_graph.wandering_errors import (
    gauss_markov_factor,
    stationary_error,
    wandering_fix_factor,
    zero_errors,
)
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix

_MARGIN_S = 1e-6  # a variable that is about to leave the window is not used any more


@dataclass
class _WindowError:
    """Variable of a wandering error: key, time of its fix, standard deviation, and up to when it was told to stay."""

    key: int
    time_s: float
    sigma_m: float
    kept_s: float = inf


class WindowErrors:
    """Variables of wandering errors in a window.

    The last one of each source stays in the window, because the next one refers to it. The others leave it like
    poses.

    Parameters
    ----------
    smoother : gtsam.IncrementalFixedLagSmoother
        Smoother of the window.
    lag_s : float
        Its lag, s.
    """

    def __init__(self, smoother: gtsam.IncrementalFixedLagSmoother, lag_s: float) -> None:
        self._smoother, self._lag_s = smoother, lag_s
        self._present: dict[tuple[str, float], _WindowError] = {}  # by source and time of the fix
        self._last: dict[str, _WindowError] = {}  # by source

    def begin(self, source: SourceState, key: int, values: gtsam.Values, mean: Array) -> None:
        """Add the error (2,) of a source at the begin of the window; its prior is left to the caller."""
        values.insert(key, mean)
        self._last[source.name] = self._present[source.name, source.time_s] = _WindowError(
            key, source.time_s, source.sigma_m
        )

    def kept(self, now_s: float) -> list[int]:
        """Return the keys that must stay in the window, and forget those that have left it."""
        for one in (*self._present.values(), *self._last.values()):
            one.kept_s = min(one.kept_s, now_s)
        for one in self._last.values():
            one.kept_s = now_s
        horizon_s = now_s - self._lag_s + _MARGIN_S
        self._present = {fix: one for fix, one in self._present.items() if one.kept_s > horizon_s}
        return [one.key for one in self._last.values()]

    def add_fixes(
        self,
        graph: gtsam.NonlinearFactorGraph,
        values: gtsam.Values,
        node: Node,
        pose: int,
        new_key: Callable[[], int],
    ) -> None:
        """Add the fixes of a node that have a wandering error, as measurements of a pose.

        A fix that another device had before has its error in the window already.
        """
        for fix in node.fixes:
            if fix.sigma_wander_m > 0.0:
                known = self._present.get((fix.source, fix.time_s))
                error = known or self._added(graph, values, fix, new_key())
                graph.add(wandering_fix_factor(pose, error.key, fix, error.sigma_m))

    def _added(
        self, graph: gtsam.NonlinearFactorGraph, values: gtsam.Values, fix: PositionFix, key: int
    ) -> _WindowError:
        """Add the error of a fix, which follows the last one of its source."""
        before, sigma_m = self._last.get(fix.source), fix.sigma_wander_m
        if before is None:
            graph.add(stationary_error(key))
            values.insert(zero_errors([key]))
        else:
            # A device that lags behind may give an older fix.
            correlation, sigma_m = wander_to(fix, before.sigma_m, abs(fix.time_s - before.time_s))
            graph.add(gauss_markov_factor(before.key, key, correlation, zero_errors([before.key, key])))
            known = values if values.exists(before.key) else None
            mean = known.atPoint2(before.key) if known else self._smoother.calculateEstimatePoint2(before.key)
            values.insert(key, correlation * mean)
        added = _WindowError(key, fix.time_s, sigma_m)
        self._last[fix.source] = self._present[fix.source, fix.time_s] = added
        return added
