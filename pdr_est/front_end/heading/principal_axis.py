"""Walking direction from the principal axis of the horizontal acceleration, its sign from the phase within the step.

Robust DR (Jin et al. 2011) section III-E names principal-component analysis of the horizontal acceleration, after
others, without a way to tell forward from backward. What is here is ours.

The trunk sways sideways once a stride (two steps) and goes slower and faster once a step. So the axis is that of the
acceleration at the frequency of the steps alone: its first harmonic over whole strides, each step stretched to the
same phase, about which the sway cancels. The trunk is fastest when it is lowest, at the heel strike, and slowest
when it has risen over the standing leg: like an inverted pendulum it exchanges height for speed. Hence the forward
acceleration is ahead of the vertical one by a quarter of a step, and forward is the end of the axis for which it is.

Measured: phones in the hand and in trouser pockets obey (OxIOD; forward leads by 91 and 95 degrees in the hand, by 78
to 84 in pockets; the coherence is 0.96 and more), those in bags and in swinging hands do not (coherence about 0.3):
there the direction is not to be trusted, and the coherence tells so.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import NDArray

from pdr_est.frames import wrap_angle
from pdr_est.front_end.heading.horizontal import to_level
from pdr_est.front_end.heading.step_yaw import calibrated_mean_yaw
from pdr_est.front_end.heading.strides import STRIDE_LATENCY_S, Strides, yaw_of
from pdr_est.params import Fraction, NonNegative, params
from pdr_est.records import CarryingMode, Step

_LEAD_RAD = 0.5 * np.pi  # of the forward before the vertical acceleration
_KNOWS_NOTHING_RAD = np.pi / np.sqrt(3.0)  # standard deviation of a uniform angle


@params
class PrincipalAxisParams:
    """strides: how many of the latest count together. least_coherence: below it the direction is not trusted.
    sigma_rad: of the direction as it differs from the walker's in a whole walk, by the way the phone is worn."""

    strides: Annotated[int, Ge(1), Le(100)] = 4
    least_coherence: Fraction = 0.6
    sigma_rad: NonNegative = 0.15


@dataclass(frozen=True)
class StrideMotion:
    """First harmonic over the steps of a stride. horizontal_mps2: (2,) complex, along the direction of zero in the
    level frame turned by the stride's mean yaw_rad, and left of it; vertical_mps2: complex."""

    horizontal_mps2: NDArray[np.complex128]
    vertical_mps2: complex
    yaw_rad: float


@dataclass(frozen=True)
class WalkingDirection:
    """Where a walker goes. offset_rad: mean yaw of the phone less the direction, in [-pi, pi). sigma_rad: standard
    deviation. coherence: 1 if the horizontal acceleration is along one line and has the phase of forward walking,
    0 if it has nothing to do with it."""

    offset_rad: float
    sigma_rad: float
    coherence: float

    def at(self, yaw_rad: float) -> float:
        """The direction in the level frame, in [-pi, pi), of a walker whose phone has this mean yaw."""
        return float(wrap_angle(yaw_rad - self.offset_rad))


class PrincipalAxis:
    """Stage Step -> Step that fills in the heading: yaw averaged over the stride less the offset of the phone.

    The offset is that of the latest strides in the same carrying mode, or the last that was trusted. A stride in
    TRANS or with a compensated step does not count. The first strides of a segment take what they have.
    """

    latency_s = STRIDE_LATENCY_S

    def __init__(self, parameters: PrincipalAxisParams) -> None:
        self._parameters = parameters
        self._strides = Strides()
        self._latest: deque[StrideMotion] = deque(maxlen=parameters.strides)
        self._begin(None)

    def push(self, item: Step, /) -> list[Step]:
        return [step for steps in self._strides.add(item) for step in self._orient(steps)]

    def flush(self) -> list[Step]:
        return [step for steps in self._strides.rest() for step in self._orient(steps)]

    def _begin(self, segment: int | None) -> None:
        self._segment = segment
        self._mode: CarryingMode | None = None
        self._direction: WalkingDirection | None = None
        self._latest.clear()

    def _orient(self, steps: Sequence[Step]) -> list[Step]:
        if steps[0].event.segment != self._segment:
            self._begin(steps[0].event.segment)
        self._learn(steps)
        yaw_rad = calibrated_mean_yaw(yaw_of(steps))
        heading_rad = yaw_rad if self._direction is None else self._direction.at(yaw_rad)
        return [replace(step, heading_rad=heading_rad) for step in steps]

    def _learn(self, steps: Sequence[Step]) -> None:
        modes = {step.event.mode for step in steps}
        if len(steps) < 2 or len(modes) > 1 or CarryingMode.TRANS in modes or any(s.event.compensated for s in steps):
            return
        mode = steps[0].event.mode
        if mode is not self._mode:
            self._mode = mode
            self._latest.clear()
        self._latest.append(stride_motion(steps))
        found = walking_direction(self._latest, self._parameters)
        if self._direction is None or found.coherence >= self._parameters.least_coherence:
            self._direction = found


def direction_of(steps: Sequence[Step], parameters: PrincipalAxisParams) -> WalkingDirection | None:
    """The walking direction over a run of steps in one carrying mode; None if it holds no whole stride."""
    strides = Strides()
    pairs = [pair for step in steps for pair in strides.add(step) if len(pair) == 2]
    return walking_direction([stride_motion(pair) for pair in pairs], parameters) if pairs else None


def stride_motion(steps: Sequence[Step]) -> StrideMotion:
    """What two steps tell."""
    horizontal, vertical = np.zeros(2, dtype=np.complex128), 0j
    for step in steps:
        samples = step.samples
        wave = np.exp(-2j * np.pi * (np.arange(len(samples)) + 0.5) / len(samples))
        level = to_level(samples.acceleration_mps2, samples.up, samples.yaw_rad)
        horizontal += np.sum(wave[:, None] * level, axis=0)
        vertical += complex(np.sum(wave * samples.vertical_mps2))
    yaw_rad = calibrated_mean_yaw(yaw_of(steps))
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    count = sum(len(step.samples) for step in steps)
    turned = np.array(
        [c * horizontal[0] + s * horizontal[1], c * horizontal[1] - s * horizontal[0]], dtype=np.complex128
    )
    return StrideMotion(turned / count, vertical / count, yaw_rad)


def walking_direction(strides: Sequence[StrideMotion], parameters: PrincipalAxisParams) -> WalkingDirection:
    """The walking direction over some strides, at least one, during which the phone stayed where it is."""
    horizontal = np.array([stride.horizontal_mps2 for stride in strides])
    vertical = np.array([stride.vertical_mps2 for stride in strides])
    # Squared length of the acceleration, and what is longer along the first axis or the diagonal than across it.
    along, across = np.abs(horizontal.T) ** 2
    total = float(np.sum(along + across))
    double = complex(np.sum(along - across), 2.0 * np.sum((horizontal[:, 0] * horizontal[:, 1].conj()).real))
    axis_rad = 0.5 * float(np.angle(double))
    ahead = horizontal @ np.array([np.cos(axis_rad), np.sin(axis_rad)])
    in_phase = float(np.sum((ahead * vertical.conj() * np.exp(-1j * _LEAD_RAD)).real))
    power = total * float(np.sum(np.abs(vertical) ** 2))
    coherence = abs(in_phase) / np.sqrt(power) if power > 0.0 else 0.0
    forward_rad = axis_rad if in_phase >= 0.0 else axis_rad + np.pi
    # Across the axis lies (total - |double|) / 2 of the square, which turns the axis of a stride this way or that.
    width = np.sqrt(max(total - abs(double), 0.0) / (total + abs(double))) if total > 0.0 else 1.0
    sigma_rad = float(np.hypot(parameters.sigma_rad, width / np.sqrt(len(strides))))
    trusted = coherence >= parameters.least_coherence
    return WalkingDirection(
        offset_rad=float(wrap_angle(-forward_rad)),
        sigma_rad=sigma_rad if trusted else _KNOWS_NOTHING_RAD,
        coherence=float(coherence),
    )
