"""Recognition of the carrying mode from how the phone moves while its carrier walks.

Not from a paper. Windows tell how likely each mode is (`evidence`), and a hidden Markov model with one state a mode
weighs them (`chain`), those a little after a time as well as those before it. A change of the mode is the likelier
the more the mean direction of gravity moves just then: that is where it is placed. Windows near such a movement say
nothing about the mode, because the phone is being taken from one place to another, nor do windows without walking.
Nothing depends on the mode at the start, and a missed change is made up for by what follows.
"""

from dataclasses import replace
from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt, Le
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.mode.hidden_markov import ModeBelief, look_ahead
from pdr_est.front_end.mode.window_features import MODES
from pdr_est.front_end.mode.windows import Windows
from pdr_est.front_end.signal.blocks import take
from pdr_est.params import Fraction, Positive, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

# Samples after a hop from which on it is labelled, and its forerunners emitted: with single samples no push has to
# judge windows and to label or emit as well.
_LABEL_AFTER, _EMIT_AFTER = 1, 2
_FLAT = 1.0 / len(MODES) + 1e-6  # a belief not above it knows nothing
_Few = Annotated[int, Ge(1), Le(100)]
_FewOrNone = Annotated[int, Ge(0), Le(100)]
_SmallProbability = Annotated[float, Gt(0.0), Le(0.3)]  # two of them still leave the old mode the likeliest


@params
class AutoModeParams:
    """hop_s: how often the mode is judged; half_hops: how many hops make half a window. walking_mps2: least standard
    deviation of the vertical acceleration of a walk in either half. moving_deg: the mean gravity of a window's
    halves differs by more while the phone is put elsewhere; spoilt_hops: so far from such a window others are
    spoilt, too. change: probability that the mode changes at a hop at which gravity stays; change_turned: how much
    more likely that is where gravity turns by a right angle. weight: of a window's evidence, below 1 because
    windows overlap. ahead_hops: how many windows after a hop count. memory_s: what was known before a gap fades in
    such a time."""

    hop_s: Annotated[Positive, Le(2.0)] = 0.25
    half_hops: _Few = 4
    walking_mps2: Positive = 0.4
    moving_deg: Annotated[Positive, Le(180.0)] = 25.0
    spoilt_hops: _FewOrNone = 3
    change: _SmallProbability = 0.002
    change_turned: _SmallProbability = 0.3
    weight: Fraction = 0.4
    ahead_hops: _FewOrNone = 5
    memory_s: Positive = 60.0


class HmmModeRecogniser:
    """Stage LevelBlock -> LevelBlock with mode and probability of every sample."""

    def __init__(self, rate_hz: float, parameters: AutoModeParams) -> None:
        p = self._parameters = parameters
        self._hop = max(round(p.hop_s * rate_hz), 2)
        self.latency_s = ((p.half_hops + p.spoilt_hops + p.ahead_hops) * self._hop + _EMIT_AFTER) / rate_hz
        self._moving = float(1.0 - np.cos(np.deg2rad(p.moving_deg)))
        self._windows = Windows(self._hop, p.half_hops, rate_hz, p.walking_mps2)
        self._belief = ModeBelief(len(MODES))
        self._pending: list[LevelBlock] = []
        self._count = 0  # samples pending
        self._mode: NDArray[np.int8] = np.empty(0, dtype=np.int8)  # labels of the first pending hops
        self._probability: Array = np.empty(0)
        self._end_s = 0.0

    def push(self, item: LevelBlock, /) -> list[LevelBlock]:
        if not len(item):
            return []
        done: list[LevelBlock] = []
        if self._pending and item.segment != self._pending[0].segment:
            done = self.flush()
            gap_s = max(float(item.time_s[0]) - self._end_s, 0.0)
            self._belief.fade(float(np.exp(-gap_s / self._parameters.memory_s)))
        self._end_s = float(item.time_s[-1])
        self._pending.append(item)
        self._count += len(item)
        self._windows.push(item)
        since = self._windows.since_hop()
        self._label(self._sure_hops() - (since < _LABEL_AFTER))
        return done + self._emit((len(self._mode) - (since < _EMIT_AFTER)) * self._hop)

    def flush(self) -> list[LevelBlock]:
        """Label what is left of the segment; nothing follows it that could say more."""
        p, rest = self._parameters, self._count
        missing = -(-rest // self._hop) - len(self._mode)
        self._windows.end(missing + p.spoilt_hops + p.ahead_hops)
        self._label(missing)
        done = self._emit(rest)
        self._windows.begin()
        return done

    def _sure_hops(self) -> int:
        """How many more hops can be labelled: complete ones whose neighbours are known."""
        p = self._parameters
        known = self._windows.ahead() - p.spoilt_hops - p.ahead_hops
        return min(known, self._count // self._hop - len(self._mode))

    def _emit(self, samples: int) -> list[LevelBlock]:
        """The first pending samples with their labels."""
        if samples <= 0:
            return []
        hops = -(-samples // self._hop)
        mode, self._mode = self._mode[:hops], self._mode[hops:]
        probability, self._probability = self._probability[:hops], self._probability[hops:]
        self._count -= samples
        return [
            replace(
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
        change = p.change + p.change_turned * np.minimum(windows.turned[rows], 1.0)
        spoilt = _near(windows.turned > self._moving, p.spoilt_hops)[rows]
        weighed = np.where(spoilt, 1.0, windows.likelihood[:, rows] ** p.weight)
        belief = self._belief.forward(change[:count], weighed[:, :count])
        belief *= look_ahead(change, weighed, count, p.ahead_hops)
        best = np.argmax(belief, axis=0)
        probability: Array = np.max(belief, axis=0) / belief.sum(axis=0)
        mode = np.where(probability > _FLAT, MODES[best], np.int8(CarryingMode.UNKNOWN))
        self._mode = np.concatenate([self._mode, mode])
        self._probability = np.concatenate([self._probability, probability])
        windows.labelled(count, keep=p.spoilt_hops)


def _near(flags: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """Whether a flag is set within `reach` places."""
    return np.convolve(flags, np.ones(2 * reach + 1, dtype=np.intp))[reach : reach + len(flags)] > 0
