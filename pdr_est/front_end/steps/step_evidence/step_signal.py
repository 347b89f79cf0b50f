"""Compute the signal that has one peak per step, whatever the position of the phone.

It is the vertical acceleration in the band of cadences; for most swinging phones it is the rotation rate. A swinging
hand rises at both ends of its arc, when a foot strikes and the trunk is lowest: the two cancel, in some people
altogether, and only strides are left in the vertical acceleration. The rotation rate is smallest at the ends of the
arc, near the strikes, whatever the arm's strength or the phone's orientation. A hand that swings gently has it the
other way round: the trunk's steps are plain, and the rotation is not. Therefore the one that repeats itself better
from step to step is taken.
"""

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.signal.event_detection import Flags
from pdr_est.front_end.signal.filters import CausalBandPass
from pdr_est.front_end.signal.vectors import dot
from pdr_est.front_end.steps.stride_period import autocorrelation
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

_SWING = np.int8(CarryingMode.SWING)
_CHOICE_S = 2.0  # time between two choices of the signal of a swinging phone
_MEMORY_S = 3.0  # length of the signals that are compared
_SHORTEST_S, _LONGEST_S = 0.36, 0.8  # time between steps at which a signal should repeat itself
_ADVANTAGE = 0.1  # correlation by which the vertical acceleration must repeat itself better; ours


class StepSignal:
    """Filter of level samples whose output has one peak per step.

    Parameters
    ----------
    low_hz, high_hz : float
        Band of cadences.
    swing_gain_mps : float
        Acceleration, m/s^2, that counts as much as a rotation rate of 1 rad/s.
    rate_hz : float
        Sampling rate.

    Attributes
    ----------
    delay_s : float
        Delay of the signal behind the movement.
    """

    def __init__(self, low_hz: float, high_hz: float, swing_gain_mps: float, rate_hz: float) -> None:
        self._filter = CausalBandPass(low_hz, high_hz, rate_hz)
        self.delay_s = self._filter.delay_s
        self._gain_mps = swing_gain_mps
        self._hop = max(round(_CHOICE_S * rate_hz), 1)
        self._memory = round(_MEMORY_S * rate_hz)
        self._lags = slice(round(_SHORTEST_S * rate_hz), round(_LONGEST_S * rate_hz) + 1)
        self.reset()

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self._filter.reset()
        self._recent: Array = np.empty((0, 2))  # both signals
        self._until_choice = self._hop
        self._takes_vertical = False

    def push(self, block: LevelBlock) -> Array:
        """Compute the signal (n,) of a block."""
        columns = np.empty((len(block), 2))
        columns[:, 0] = block.vertical_mps2
        columns[:, 1] = horizontal_rotation_rate(block)
        filtered = self._filter.push(columns)
        # The mode may be given as SWING for a device without gyroscope, whose rotation is NaN.
        is_swing = (block.mode == _SWING) & np.isfinite(filtered[:, 1])
        filtered[:, 1] *= -self._gain_mps
        rotates = is_swing & ~self._vertical_chosen(filtered, is_swing)
        signal: Array = np.where(rotates, filtered[:, 1], filtered[:, 0])
        return signal

    def _vertical_chosen(self, signals: Array, is_swing: Flags) -> Flags:
        """Mark the samples (n,) of a swinging phone whose vertical acceleration is the better signal."""
        known = np.concatenate([self._recent, signals])
        first = len(self._recent)
        marks = np.empty(len(signals), dtype=np.bool_)
        done = 0
        while done < len(signals):
            count = min(self._until_choice, len(signals) - done)
            marks[done : done + count] = self._takes_vertical
            done += count
            self._until_choice -= count
            if self._until_choice == 0:
                self._until_choice = self._hop
                recent = known[max(first + done - self._memory, 0) : first + done]
                self._takes_vertical = bool(is_swing[done - 1]) and self._vertical_is_steadier(recent)
        self._recent = known[-self._memory :]
        return marks

    def _vertical_is_steadier(self, recent: Array) -> bool:
        """Check whether the vertical acceleration repeats itself better than the rotation rate."""
        if len(recent) < self._memory:
            return False
        longest = self._lags.stop - 1
        vertical, rotation = (float(autocorrelation(column, longest)[self._lags].max()) for column in recent.T.copy())
        return vertical > rotation + _ADVANTAGE


def horizontal_rotation_rate(block: LevelBlock) -> Array:
    """Compute the rotation rate about horizontal axes, (n,) rad/s: the swing of a limb without the walker's turns."""
    rotation, turning = block.rotation_rate_radps, block.turn_rate_radps
    rate: Array = np.sqrt(np.maximum(dot(rotation, rotation) - turning * turning, 0.0))
    return rate
