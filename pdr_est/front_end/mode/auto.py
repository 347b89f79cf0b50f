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
from pdr_est.front_end.mode.chain import Chain, look_ahead
from pdr_est.front_end.mode.evidence import COLUMNS, MODES, hop_means, likelihoods, turned
from pdr_est.front_end.signal.blocks import join, part
from pdr_est.params import Fraction, Positive, params
from pdr_est.records import CarryingMode, LevelBlock

_FLAT = 1.0 / len(MODES) + 1e-6  # a belief not above it knows nothing
_Few = Annotated[int, Ge(1), Le(100)]
_FewOrNone = Annotated[int, Ge(0), Le(100)]
_SmallProbability = Annotated[float, Gt(0.0), Le(0.375)]  # two of them still leave each state its chance


@params
class AutoModeParams:
    """hop_s: how often the mode is judged; half_hops: how many hops make half a window. walking_mps2: least standard
    deviation of the vertical acceleration of a walk in either half. moving_deg: the mean gravity of a window's
    halves differs by more while the phone is put elsewhere; spoilt_hops: so far from such a window others are
    spoilt, too. change: probability that the mode changes at a hop at which gravity stays; change_turned: how much
    more likely that is where gravity turns by a right angle. weight: of a window's evidence, below 1 because
    windows overlap. ahead_hops: how many windows after a hop count. memory_s: what was known before a gap fades in
    such a time."""

    hop_s: Positive = 0.25
    half_hops: _Few = 4
    walking_mps2: Positive = 0.4
    moving_deg: Positive = 25.0
    spoilt_hops: _FewOrNone = 3
    change: _SmallProbability = 0.002
    change_turned: _SmallProbability = 0.3
    weight: Fraction = 0.4
    ahead_hops: _FewOrNone = 5
    memory_s: Positive = 60.0


class AutoMode:
    """Stage LevelBlock -> LevelBlock with mode and probability of every sample."""

    def __init__(self, rate_hz: float, parameters: AutoModeParams) -> None:
        p = self._parameters = parameters
        self._rate_hz = rate_hz
        self._hop = max(round(p.hop_s * rate_hz), 2)
        self.latency_s = ((p.half_hops + p.spoilt_hops + p.ahead_hops) * self._hop + 1) / rate_hz
        self._moving = float(1.0 - np.cos(np.deg2rad(p.moving_deg)))
        self._pending: list[LevelBlock] = []
        self._chain = Chain(len(MODES))
        self._end_s = 0.0
        self._begin()

    def push(self, item: LevelBlock, /) -> list[LevelBlock]:
        if not len(item):
            return []
        done: list[LevelBlock] = []
        if self._pending and item.segment != self._pending[0].segment:
            done = self.flush()
            gap_s = max(float(item.time_s[0]) - self._end_s, 0.0)
            self._chain.fade(float(np.exp(-gap_s / self._parameters.memory_s)))
        self._end_s = float(item.time_s[-1])
        self._pending.append(item)
        self._count += len(item)
        self._sum_hops()
        return done + self._emit(self._sure_hops() * self._hop)

    def flush(self) -> list[LevelBlock]:
        """Label what is left of the segment; nothing follows it that could say more."""
        if not self._pending:
            return []
        p, rest = self._parameters, self._count
        needed = self._past + -(-rest // self._hop) + p.spoilt_hops + p.ahead_hops
        missing = max(needed - len(self._turned), 0)
        self._append(np.zeros(missing), np.ones((missing, len(MODES))))
        done = self._emit(rest)
        self._pending.clear()
        self._begin()
        return done

    def _begin(self) -> None:
        """A new segment. A row a hop: how far gravity turns at its beginning, and what the window about that time
        tells; there is none about the first hops."""
        half = self._parameters.half_hops
        self._count = 0  # samples pending
        self._summed = 0  # of them, those in hops that have been judged
        self._means: Array = np.empty((0, COLUMNS))
        self._past = 0  # rows kept for their neighbours' sake, of hops already labelled
        self._turned: Array = np.zeros(half)
        self._likelihood: Array = np.ones((half, len(MODES)))

    def _append(self, turned: Array, likelihood: Array) -> None:
        self._turned = np.concatenate([self._turned, turned])
        self._likelihood = np.concatenate([self._likelihood, likelihood])

    def _sum_hops(self) -> None:
        """Judge the windows that further complete hops make. Hops lie on the sample index of the segment."""
        count = (self._count - self._summed) // self._hop
        if not count:
            return
        self._pending = [join(self._pending)]
        fresh = part(self._pending[0], self._summed, self._summed + count * self._hop)
        self._summed += count * self._hop
        self._means = np.concatenate([self._means, hop_means(fresh, self._hop, self._rate_hz, self._means[-1:])])
        half = self._parameters.half_hops
        windows = len(self._means) - 2 * half + 1
        if windows < 1:
            return
        halves = _running_means(self._means, half)
        early, late = halves[:windows], halves[half : half + windows]
        self._append(turned(early, late), likelihoods(early, late, self._parameters.walking_mps2))
        self._means = self._means[windows:]

    def _sure_hops(self) -> int:
        """How many hops can be labelled. The latest row counts from the first sample after its window on, so that
        with single samples no push has to judge and to label as well."""
        known = len(self._turned) - (self._count == self._summed)
        return max(known - self._parameters.spoilt_hops - self._parameters.ahead_hops - self._past, 0)

    def _label(self, count: int) -> tuple[NDArray[np.int8], Array]:
        """Mode and probability of the next `count` hops."""
        p, first = self._parameters, self._past
        rows = slice(first, first + count + p.ahead_hops)
        change = p.change + p.change_turned * np.minimum(self._turned[rows], 1.0)
        spoilt = _near(self._turned > self._moving, p.spoilt_hops)[rows]
        weighed = np.where(spoilt[:, None], 1.0, self._likelihood[rows] ** p.weight)
        belief = self._chain.forward(change[:count].tolist(), weighed[:count].tolist())
        belief *= look_ahead(change, weighed, count, p.ahead_hops)
        total = belief[:, 0] + belief[:, 1] + belief[:, 2] + belief[:, 3]
        best = np.argmax(belief, axis=1)
        probability: Array = belief[np.arange(count), best] / total
        mode = np.where(probability > _FLAT, np.array(MODES, dtype=np.int8)[best], np.int8(CarryingMode.UNKNOWN))
        self._past = min(first + count, p.spoilt_hops)
        self._turned = self._turned[first + count - self._past :]
        self._likelihood = self._likelihood[first + count - self._past :]
        return mode, probability

    def _emit(self, samples: int) -> list[LevelBlock]:
        """The first pending samples with their labels."""
        if not samples:
            return []
        mode, probability = self._label(-(-samples // self._hop))
        pending = join(self._pending)
        self._pending = [part(pending, samples, self._count)]
        self._count -= samples
        self._summed -= samples
        return [
            replace(
                part(pending, 0, samples),
                mode=np.repeat(mode, self._hop)[:samples],
                mode_probability=np.repeat(probability, self._hop)[:samples],
            )
        ]


def _running_means(values: Array, width: int) -> Array:
    """Means over each `width` consecutive rows."""
    count = len(values) - width + 1
    total = values[:count].copy()
    for k in range(1, width):
        total += values[k : k + count]
    return total / width


def _near(flags: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """Whether a flag is set within `reach` places."""
    return np.convolve(flags, np.ones(2 * reach + 1, dtype=np.intp), "same") > 0
