"""The carrying-mode state machine of MMPDR.

The machine starts in HOLDING. A rotation rate above its threshold begins a transition; after two seconds the
direction of gravity during them tells the new mode.

Deviations from the paper. (1) The 100-sample window at 50 Hz is a duration. (2) Table I compares the rotation rate
itself with its threshold; a transition may turn the phone either way, so its magnitude is taken. (3) The paper's
gravity has Apple's sign, which points down; here it is minus the unit vector up. (4) The machine starts again after a
gap in the recording.

References
----------
MMPDR: Tian et al., IEEE Sensors Journal 2016, section III-B, Tables I and II; section IV-A for the thresholds.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.params import Positive, Window, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode


@params
class MmpdrModeParams:
    """Thresholds of MMPDR's mode state machine (section IV-A)."""

    rotation_y_radps: Positive = 3.0
    """R_y, rotation rate about the y axis above which a transition begins in HOLDING and SWING, rad/s."""
    rotation_z_radps: Positive = 5.0
    """R_z, rotation rate about the z axis above which a transition begins in HOLDING and POCKET, rad/s."""
    holding_gravity: Positive = 0.65
    """GH_y = GH_z, least gravity along -y or -z of a held phone, in units of g."""
    swing_gravity_x: Positive = 0.9
    """GS_x, least magnitude of gravity along x of a swinging phone, in units of g."""
    swing_gravity_z: Positive = 0.4
    """GS_z, gravity along z that no sample of a transition to SWING reaches, in units of g."""
    window_s: Window = 2.0
    """Duration of a transition, during which gravity is watched, s."""


class MmpdrMode:
    """Stage LevelBlock -> LevelBlock that fills in the mode of every sample; samples of a transition are TRANS.

    Every sample is labelled at once. The latency is that of a change: the new mode is decided a window after the
    phone began to move.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : MmpdrModeParams
        Thresholds and the length of the window.

    References
    ----------
    MMPDR, Tables I and II.
    """

    def __init__(self, rate_hz: float, parameters: MmpdrModeParams) -> None:
        self._parameters = parameters
        self._window = max(round(parameters.window_s * rate_hz), 1)
        self.latency_s = self._window / rate_hz
        self._segment: int | None = None
        self._begin(None)

    def push(self, item: LevelBlock, /) -> list[LevelBlock]:
        """Label the samples of a block."""
        if item.segment != self._segment:
            self._begin(item.segment)
        gravity, rate = -item.up, np.abs(item.rotation_rate_radps)
        mode = np.empty(len(item), dtype=np.int8)
        i = 0
        while i < len(item):
            i = (
                self._label_transition(gravity, mode, i)
                if self._mode is CarryingMode.TRANS
                else self._label_mode(rate, mode, i)
            )
        return [replace(item, mode=mode, mode_probability=np.ones(len(item)))]

    def flush(self) -> list[LevelBlock]:
        """Return nothing: no sample is held back."""
        return []

    def _begin(self, segment: int | None) -> None:
        self._segment = segment
        self._mode = self._mode_before = CarryingMode.HOLDING
        self._watched = 0
        self._saw_holding = self._saw_swing = False
        self._z_below = True

    def _label_mode(self, rate: NDArray[np.float64], mode: NDArray[np.int8], start: int) -> int:
        """Label samples until a transition begins (Table II); return the index after the last one labelled."""
        y = rate[start:, 1] > self._parameters.rotation_y_radps
        z = rate[start:, 2] > self._parameters.rotation_z_radps
        monitored = {CarryingMode.HOLDING: y | z, CarryingMode.SWING: y, CarryingMode.POCKET: z}[self._mode]
        stop = start + int(np.argmax(monitored)) if monitored.any() else len(mode)
        mode[start:stop] = self._mode
        if stop < len(mode):
            self._mode_before, self._mode, self._watched = self._mode, CarryingMode.TRANS, 0
            self._saw_holding = self._saw_swing = False
            self._z_below = True
        return stop

    def _label_transition(self, gravity: NDArray[np.float64], mode: NDArray[np.int8], start: int) -> int:
        """Watch gravity until the window is over, then decide (Table I)."""
        p = self._parameters
        stop = min(start + self._window - self._watched, len(mode))
        x, y, z = gravity[start:stop].T
        flat = ((y < -p.holding_gravity) & (z < 0.0)) | ((z < -p.holding_gravity) & (y < 0.0))
        self._saw_holding |= bool(flat.any())
        self._saw_swing |= bool((np.abs(x) > p.swing_gravity_x).any())
        self._z_below &= bool((z < p.swing_gravity_z).all())
        mode[start:stop] = CarryingMode.TRANS
        self._watched += stop - start
        if self._watched == self._window:
            self._mode = self._mode_after_transition()
        return stop

    def _mode_after_transition(self) -> CarryingMode:
        if self._mode_before is CarryingMode.HOLDING:
            return CarryingMode.SWING if self._saw_swing and self._z_below else CarryingMode.POCKET
        if self._saw_holding:
            return CarryingMode.HOLDING
        return CarryingMode.POCKET if self._mode_before is CarryingMode.SWING else CarryingMode.SWING
