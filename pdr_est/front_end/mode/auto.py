"""Recognition of the carrying mode from how the phone swings while its carrier walks.

Not from a paper. Three numbers of a sliding window tell the modes apart, for anybody and any way to hold the phone:

* the swing of the direction of gravity in device axes: 1 to 5 degrees in a hand held still, 5 to 18 in a trouser
  pocket, above 17 in a swinging hand;
* how much of the rotation is about a single axis: nearly all of it for an arm, two thirds for a thigh;
* whether the screen faces up, as only a phone looked at does.

Their likelihoods drive a hidden Markov model with one state a mode. Windows without walking say nothing, nor do
windows in which the mean direction of gravity moves: the phone is being taken from one place to another. Nothing
depends on the mode at the start, and a missed change is made up for by the windows after it.
"""

from dataclasses import replace
from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt, Lt
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.signal.blocks import join, part
from pdr_est.params import Positive, params
from pdr_est.records import CarryingMode, LevelBlock

MODES = (CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET, CarryingMode.OTHER)

# Typical swing of gravity in degrees, the spread of its logarithm, typical share of the main axis, and its spread.
# Fitted by eye to the held, swung, pocket and bag walks of the data sets in the README and to MotionSense.
_SWING_DEG = np.array([2.6, 26.0, 11.0, 3.0])
_SWING_SPREAD = np.array([0.6, 0.45, 0.5, 0.6])
_SHARE = np.array([0.6, 0.94, 0.69, 0.65])
_SHARE_SPREAD = np.array([0.3, 0.04, 0.12, 0.3])
_LEAST_LIKELIHOOD = 1e-4  # no single window is proof
_SCREEN_UP = 0.3  # least part of gravity along the screen's normal of a phone that is looked at
_SCREEN_SPREAD = 0.1
_SCREEN_WEIGHT = np.array([0.9, 0.98, 0.98])  # how sure it is that no phone in the other modes shows its screen


@params
class AutoModeParams:
    """hop_s: how often the mode is judged; hops: how many of them make a window. walking_mps2: least standard
    deviation of the vertical acceleration of a walk. moving_deg: the mean gravity of the window's halves
    differs by more while the phone is put elsewhere. stay: probability to keep the mode from one hop to
    the next. changing: probability to have changed it while the phone was put elsewhere."""

    hop_s: Positive = 0.5
    hops: Annotated[int, Ge(2)] = 4
    walking_mps2: Positive = 0.4
    moving_deg: Positive = 25.0
    stay: Annotated[float, Gt(0.0), Lt(1.0)] = 0.95
    changing: Annotated[float, Gt(0.0), Lt(1.0)] = 0.3


class AutoMode:
    """Stage LevelBlock -> LevelBlock with mode and probability of every sample, a window later."""

    def __init__(self, rate_hz: float, parameters: AutoModeParams) -> None:
        self._parameters = parameters
        self._hop = max(round(parameters.hop_s * rate_hz), 1)
        self.latency_s = parameters.hop_s * (parameters.hops + 1)
        self._pending: LevelBlock | None = None
        self._begin()

    def push(self, item: LevelBlock, /) -> list[LevelBlock]:
        if not len(item):
            return []
        done: list[LevelBlock] = []
        if self._pending is not None and item.segment != self._pending.segment:
            done = self.flush()
        self._pending = item if self._pending is None else join([self._pending, item])
        self._sum_hops()
        return done + self._judge()

    def flush(self) -> list[LevelBlock]:
        """Label what is left of the segment with the last mode."""
        rest, self._pending = self._pending, None
        mode, probability = self._mode()
        self._begin()
        if rest is None or not len(rest):
            return []
        return [_labelled(rest, np.full(len(rest), mode), np.full(len(rest), probability))]

    def _begin(self) -> None:
        self._summed = 0
        self._first = True
        self._sums: Array = np.empty((0, 14))
        self._belief = np.full(len(MODES), 1.0 / len(MODES))

    def _sum_hops(self) -> None:
        """Sums of the moments over each complete hop, laid on the sample index of the segment."""
        if self._pending is None:
            return
        count = (len(self._pending) - self._summed) // self._hop
        if not count:
            return
        fresh = part(self._pending, self._summed, self._summed + count * self._hop)
        moments = _moments(fresh)
        self._sums = np.concatenate([self._sums, moments.reshape(count, self._hop, -1).sum(axis=1)])
        self._summed += count * self._hop

    def _judge(self) -> list[LevelBlock]:
        """One decision a window; a window settles its second hop, the first one also the hop before it."""
        hops = self._parameters.hops
        count = len(self._sums) - hops + 1
        if count < 1 or self._pending is None:
            return []
        total = self._sums[:count].copy()
        for k in range(1, hops):
            total += self._sums[k : k + count]
        likelihood, walking = _likelihood(total / (hops * self._hop), self._parameters.walking_mps2)
        moving = self._moving(count)
        labels = [self._update(*evidence) for evidence in zip(likelihood, walking, moving, strict=True)]
        if self._first:
            labels.insert(0, labels[0])
            self._first = False
        self._sums = self._sums[count:]
        return self._emit(labels)

    def _moving(self, count: int) -> NDArray[np.bool_]:
        """Whether the mean gravity of the halves of each window differs much."""
        half = self._parameters.hops // 2
        early, late = self._sums[:count, :3].copy(), self._sums[half : half + count, :3].copy()
        for k in range(1, half):
            early += self._sums[k : k + count, :3]
            late += self._sums[half + k : half + k + count, :3]
        dot = early[:, 0] * late[:, 0] + early[:, 1] * late[:, 1] + early[:, 2] * late[:, 2]
        return np.asarray(dot < np.cos(np.deg2rad(self._parameters.moving_deg)) * _norm(early) * _norm(late))

    def _update(self, likelihood: Array, walking: bool, moving: bool) -> tuple[CarryingMode, float]:
        """One step of the forward recursion."""
        p = self._parameters
        if moving:
            self._belief = (1.0 - p.changing) * self._belief + p.changing / len(MODES)
        elif walking:
            leave = (1.0 - p.stay) / (len(MODES) - 1)
            predicted = (p.stay - leave) * self._belief + leave
            belief = predicted * likelihood
            self._belief = belief / belief.sum()
        return self._mode()

    def _mode(self) -> tuple[CarryingMode, float]:
        """The likeliest mode and its probability; UNKNOWN while nobody has walked."""
        best = int(np.argmax(self._belief))
        known = self._belief[best] > self._belief.mean()
        return MODES[best] if known else CarryingMode.UNKNOWN, float(self._belief[best])

    def _emit(self, labels: list[tuple[CarryingMode, float]]) -> list[LevelBlock]:
        if self._pending is None:
            return []
        count = len(labels) * self._hop
        modes = np.repeat([mode for mode, _ in labels], self._hop)
        probability = np.repeat([probability for _, probability in labels], self._hop)
        ready = part(self._pending, 0, count)
        self._pending = part(self._pending, count, len(self._pending))
        self._summed -= count
        return [_labelled(ready, modes, probability)]


def _labelled(block: LevelBlock, mode: NDArray[np.int64], probability: Array) -> LevelBlock:
    return replace(block, mode=mode.astype(np.int8), mode_probability=probability)


def _moments(block: LevelBlock) -> Array:
    """Columns: up (3), rotation rate (3), its products xx yy zz xy xz yz, vertical acceleration and its square."""
    x, y, z = block.rotation_rate_radps.T
    v = block.vertical_mps2
    return np.column_stack([block.up, x, y, z, x * x, y * y, z * z, x * y, x * z, y * z, v, v * v])


def _likelihood(mean: Array, walking_mps2: float) -> tuple[Array, NDArray[np.bool_]]:
    """Likelihood (n, modes) of windows with these mean moments (n, 14), and whether their walker walks."""
    up, length = mean[:, :3], _norm(mean[:, :3])
    swing_deg = np.rad2deg(np.sqrt(np.maximum(1.0 - length * length, 1e-8)))
    share = _share_of_main_axis(mean[:, 3:6], mean[:, 6:12])
    z_swing = (np.log(swing_deg)[:, None] - np.log(_SWING_DEG)) / _SWING_SPREAD
    z_share = (share[:, None] - _SHARE) / _SHARE_SPREAD
    density = np.exp(-0.5 * (z_swing**2 + z_share**2)) / (_SWING_SPREAD * _SHARE_SPREAD)
    screen_up = 1.0 / (1.0 + np.exp((_SCREEN_UP - up[:, 2] / length) / _SCREEN_SPREAD))
    density[:, 0] *= screen_up
    density[:, 1:] *= 1.0 - _SCREEN_WEIGHT * screen_up[:, None]
    likelihood: Array = density / density.sum(axis=1)[:, None] + _LEAST_LIKELIHOOD
    walking = mean[:, 13] - mean[:, 12] ** 2 > walking_mps2**2
    return likelihood, walking


def _share_of_main_axis(rate: Array, products: Array) -> Array:
    """Largest eigenvalue of the covariance of the rotation rate over their sum, (n,)."""
    covariance = np.empty((len(rate), 3, 3))
    for column, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
        covariance[:, i, j] = covariance[:, j, i] = products[:, column] - rate[:, i] * rate[:, j]
    values = np.linalg.eigvalsh(covariance)
    share: Array = values[:, 2] / np.maximum(values.sum(axis=1), 1e-12)
    return share


def _norm(vectors: Array) -> Array:
    norm: Array = np.sqrt(vectors[:, 0] ** 2 + vectors[:, 1] ** 2 + vectors[:, 2] ** 2)
    return norm
