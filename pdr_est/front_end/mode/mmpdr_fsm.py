"""The carrying-mode state machine of MMPDR (Tian et al. 2016), section III-B, Tables I and II.

The machine starts in HOLDING. A rotation rate above its threshold begins a transition; after two seconds the
direction of gravity during them tells the new mode.

Deviations from the paper. (1) The 100-sample window at 50 Hz is a duration. (2) Table I compares the rotation rate
itself with its threshold; a transition may turn the phone either way, so its magnitude is taken. (3) The paper's
gravity has Apple's sign, which points down; here it is minus the unit vector up. (4) The machine starts anew after a
gap in the recording.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.params import Positive, Window, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode


@params
class MmpdrModeParams:
    """Thresholds of section IV-A: rotation_y_radps R_y, rotation_z_radps R_z; holding_gravity GH_y = GH_z,
    swing_gravity_x GS_x, swing_gravity_z GS_z in units of gravity. window_s: how long a transition is watched."""

    rotation_y_radps: Positive = 3.0
    rotation_z_radps: Positive = 5.0
    holding_gravity: Positive = 0.65
    swing_gravity_x: Positive = 0.9
    swing_gravity_z: Positive = 0.4
    window_s: Window = 2.0


class MmpdrMode:
    """Stage LevelBlock -> LevelBlock with the mode of every sample; samples of a transition are TRANS.

    Every sample is labelled at once. The latency is that of a change: the new mode is decided a window after the
    phone began to move.
    """

    def __init__(self, rate_hz: float, parameters: MmpdrModeParams) -> None:
        self._parameters = parameters
        self._window = max(round(parameters.window_s * rate_hz), 1)
        self.latency_s = self._window / rate_hz
        self._segment: int | None = None
        self._begin(None)

    def push(self, item: LevelBlock, /) -> list[LevelBlock]:
        if item.segment != self._segment:
            self._begin(item.segment)
        gravity, rate = -item.up, np.abs(item.rotation_rate_radps)
        mode = np.empty(len(item), dtype=np.int8)
        i = 0
        while i < len(item):
            i = self._watch(gravity, mode, i) if self._mode is CarryingMode.TRANS else self._walk(rate, mode, i)
        return [replace(item, mode=mode, mode_probability=np.ones(len(item)))]

    def flush(self) -> list[LevelBlock]:
        return []

    def _begin(self, segment: int | None) -> None:
        self._segment = segment
        self._mode = self._before = CarryingMode.HOLDING
        self._watched = 0
        self._saw_holding = self._saw_swing = False
        self._z_below = True

    def _walk(self, rate: NDArray[np.float64], mode: NDArray[np.int8], start: int) -> int:
        """Label samples until a transition begins (Table II); return the index after the last one labelled."""
        y = rate[start:, 1] > self._parameters.rotation_y_radps
        z = rate[start:, 2] > self._parameters.rotation_z_radps
        monitored = {CarryingMode.HOLDING: y | z, CarryingMode.SWING: y, CarryingMode.POCKET: z}[self._mode]
        stop = start + int(np.argmax(monitored)) if monitored.any() else len(mode)
        mode[start:stop] = self._mode
        if stop < len(mode):
            self._before, self._mode, self._watched = self._mode, CarryingMode.TRANS, 0
            self._saw_holding = self._saw_swing = False
            self._z_below = True
        return stop

    def _watch(self, gravity: NDArray[np.float64], mode: NDArray[np.int8], start: int) -> int:
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
            self._mode = self._after()
        return stop

    def _after(self) -> CarryingMode:
        if self._before is CarryingMode.HOLDING:
            return CarryingMode.SWING if self._saw_swing and self._z_below else CarryingMode.POCKET
        if self._saw_holding:
            return CarryingMode.HOLDING
        return CarryingMode.POCKET if self._before is CarryingMode.SWING else CarryingMode.SWING
