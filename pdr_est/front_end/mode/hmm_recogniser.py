"""Recognise the carrying mode from how the phone moves while its carrier walks.

Not from a paper. `SlidingWindows` tell how likely each mode is, and a hidden Markov model with one state for each
mode weighs them, those a little after a time as well as those before it. A change of the mode is the more likely the
more the mean direction of gravity moves just then: that is where the change is put. Windows near such a movement say
nothing about the mode, because the phone is being taken from one place to another, nor do windows without walking.
Nothing depends on the mode at the start, and what follows makes up for a missed change.
"""

from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt, Le
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.mode.hidden_markov import ModeBelief, backward_likelihood
from pdr_est.front_end.mode.sliding_windows import SlidingWindows
from pdr_est.front_end.mode.window_features import MODES
from pdr_est.front_end.signal.blocks import take
from pdr_est.params import Fraction, Positive, params
from pdr_est.records import changed
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

# Number of samples after a hop at which it is labelled, and at which labelled hops are emitted: when samples come one
# at a time, no push has to evaluate windows and to label or emit as well.
_LABEL_AFTER, _EMIT_AFTER = 1, 2
_UNIFORM = 1.0 / len(MODES) + 1e-6  # a probability not above it carries no information
_Count = Annotated[int, Ge(1), Le(100)]
_CountOrZero = Annotated[int, Ge(0), Le(100)]
_SmallProbability = Annotated[float, Gt(0.0), Le(0.3)]  # two of them still leave the old mode the most likely


@params
class AutoModeParams:
    """Parameters of the mode recogniser; all values are ours."""

    hop_s: Annotated[Positive, Le(2.0)] = 0.25
    """Time between two decisions about the mode, s."""
    half_hops: _Count = 4
    """Number of hops in half a window."""
    walking_mps2: Positive = 0.4
    """Least standard deviation of the vertical acceleration of a walk in either half of a window, m/s^2."""
    moving_deg: Annotated[Positive, Le(180.0)] = 25.0
    """Angle between the mean gravity of a window's halves above which the phone is being put elsewhere, degrees."""
    spoilt_hops: _CountOrZero = 3
    """Number of hops around such a window in which other windows are ignored, too."""
    change: _SmallProbability = 0.002
    """Probability that the mode changes at a hop at which gravity keeps its direction."""
    change_turned: _SmallProbability = 0.3
    """Increase of that probability where gravity turns by a right angle."""
    weight: Fraction = 0.4
    """Weight of a window's log likelihood, below 1 because windows overlap."""
    ahead_hops: _CountOrZero = 5
    """Number of windows after a hop that count for its mode."""
    memory_s: Positive = 60.0
    """Time constant, s, with which the knowledge from before a gap decays."""


class HmmModeRecogniser:
    """Stage LevelBlock -> LevelBlock that fills in the mode of every sample and its probability.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : AutoModeParams
        Windows and transition probabilities.
    """

    def __init__(self, rate_hz: float, parameters: AutoModeParams) -> None:
        p = self._parameters = parameters
        self._hop = max(round(p.hop_s * rate_hz), 2)
        self.latency_s = ((p.half_hops + p.spoilt_hops + p.ahead_hops) * self._hop + _EMIT_AFTER) / rate_hz
        self._moving_turn = float(1.0 - np.cos(np.deg2rad(p.moving_deg)))
        self._windows = SlidingWindows(self._hop, p.half_hops, rate_hz, p.walking_mps2)
        self._belief = ModeBelief()
        self._pending: list[LevelBlock] = []
        self._count = 0  # samples pending
        self._mode: NDArray[np.int8] = np.empty(0, dtype=np.int8)  # labels of the first pending hops
        self._probability: Array = np.empty(0)
        self._end_s = 0.0

    def push(self, item: LevelBlock, /) -> list[LevelBlock]:
        """Take samples and return those whose mode is now decided."""
        if not len(item):
            return []
        done: list[LevelBlock] = []
        if self._pending and item.segment != self._pending[0].segment:
            done = self.flush()
            gap_s = max(float(item.time_s[0]) - self._end_s, 0.0)
            self._belief.relax(float(np.exp(-gap_s / self._parameters.memory_s)))
        self._end_s = float(item.time_s[-1])
        self._pending.append(item)
        self._count += len(item)
        self._windows.push(item)
        since = self._windows.samples_since_hop()
        self._label(self._decidable_hops() - (since < _LABEL_AFTER))
        return done + self._emit((len(self._mode) - (since < _EMIT_AFTER)) * self._hop)

    def flush(self) -> list[LevelBlock]:
        """Label what is left of the segment; nothing follows it that could say more."""
        p, rest = self._parameters, self._count
        missing = -(-rest // self._hop) - len(self._mode)
        self._windows.end_segment(missing + p.spoilt_hops + p.ahead_hops)
        self._label(missing)
        done = self._emit(rest)
        self._windows.begin_segment()
        return done

    def _decidable_hops(self) -> int:
        """Count the further hops that can be labelled: complete ones whose neighbours are known."""
        p = self._parameters
        known = self._windows.rows_ahead() - p.spoilt_hops - p.ahead_hops
        return min(known, self._count // self._hop - len(self._mode))

    def _emit(self, samples: int) -> list[LevelBlock]:
        """Return the first pending samples with their labels."""
        if samples <= 0:
            return []
        hops = -(-samples // self._hop)
        mode, self._mode = self._mode[:hops], self._mode[hops:]
        probability, self._probability = self._probability[:hops], self._probability[hops:]
        self._count -= samples
        return [
            changed(
                take(self._pending, samples),
                mode=np.repeat(mode, self._hop)[:samples],
                mode_probability=np.repeat(probability, self._hop)[:samples],
            )
        ]

    def _label(self, count: int) -> None:
        """Find mode and probability of the next `count` hops."""
        if count <= 0:
            return
        p, windows = self._parameters, self._windows
        rows = slice(windows.past, windows.past + count + p.ahead_hops)
        change = p.change + p.change_turned * np.minimum(windows.gravity_turn[rows], 1.0)
        disturbed = _dilate(windows.gravity_turn > self._moving_turn, p.spoilt_hops)[rows]
        weighted = np.where(disturbed, 1.0, windows.likelihood[:, rows] ** p.weight)
        belief = self._belief.forward(change[:count], weighted[:, :count])
        belief *= backward_likelihood(change, weighted, count, p.ahead_hops)
        best = np.argmax(belief, axis=0)
        probability: Array = np.max(belief, axis=0) / belief.sum(axis=0)
        mode = np.where(probability > _UNIFORM, MODES[best], np.int8(CarryingMode.UNKNOWN))
        self._mode = np.concatenate([self._mode, mode])
        self._probability = np.concatenate([self._probability, probability])
        windows.mark_labelled(count, keep=p.spoilt_hops)


def _dilate(flags: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """Mark the places that have a set flag within `reach` places."""
    return np.convolve(flags, np.ones(2 * reach + 1, dtype=np.intp))[reach : reach + len(flags)] > 0
