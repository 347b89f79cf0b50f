"""Orientation of MMPDR: step yaw averages and adaptive offset compensation.

    mode      yaw averaged over (Table IV)    after a transition into it (Table V)
    HOLDING   each step                       the average as it is: the phone points ahead
    SWING     each step                       offset trained with 3 steps
    POCKET    every two steps                 2 steps omitted, offset trained with the next 4, two by two

The offset is the mean orientation of the training steps less the orientation O_b of the last valid step before the
transition, and is taken off the orientations of all later steps in the mode. The steps of the transition and of the
training keep O_b; so do compensated steps, which were not observed.

Readings of the paper. (1) Both steps of a pair get the orientation of the pair, so the first waits for the second.
One that stays alone, before a standstill, a change of mode, a gap or the end, is averaged by itself. (2) Every
transition trains again, also one that comes back to the same mode. One that comes before the training is over begins
a new training with the same O_b. (3) The paper's walks begin HOLDING. In a walk that begins otherwise there is no
O_b, and since the zero of the headings is arbitrary the yaw is taken as it is, until the first transition. The same
holds for a transition at the very beginning.

Deviations. (1) Table IV as in `step_yaw`: the shift by 2 pi only where angles straddle +-pi. (2) Recognisers other
than the paper's may know no TRANS: there a change of the mode from one step to the next is the transition. The last
step before it may already have turned the phone, of which the paper's method knows nothing. (3) Modes that the paper
has not: OTHER is trained and averaged as POCKET, for it is a place on the body, with an offset of its own and the
rhythm of the stride; UNKNOWN is no news: the mode before goes on, HOLDING at the beginning.

References
----------
MMPDR: Tian et al., IEEE Sensors Journal 2016, section III-E, Tables IV and V; section IV-A; Table IX for offsets.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Ge, Le

from pdr_est.frames import wrap_angle
from pdr_est.front_end.heading.step_yaw import calibrated_mean_yaw
from pdr_est.front_end.heading.stride_pairing import STRIDE_LATENCY_S, StridePairing, mean_yaw_of
from pdr_est.params import params
from pdr_est.types.steps import CarryingMode, Step

_Count = Annotated[int, Ge(1), Le(100)]
_STRIDE_MODES = (CarryingMode.POCKET, CarryingMode.OTHER)


@params
class MmpdrHeadingParams:
    """Numbers of steps of the training stages (section IV-A)."""

    swing_steps: _Count = 3
    """M_SWING, number of training steps in SWING."""
    pocket_steps: _Count = 6
    """M_POCKET, number of training steps in POCKET, the omitted ones included."""
    omitted_steps: Annotated[int, Ge(0), Le(100)] = 2
    """M_omit, number of omitted steps at the beginning of the training in POCKET."""


class TrainedOffset(NamedTuple):
    """Offset of the phone's yaw, as it was trained.

    Attributes
    ----------
    time_s : float
        Time of the last training step.
    mode : CarryingMode
        Mode to which the offset belongs.
    offset_rad : float
        Yaw less heading, in [-pi, pi).
    """

    time_s: float
    mode: CarryingMode
    offset_rad: float


class _Training:
    """Training stage after a transition (Table V); `baseline_rad` is O_b."""

    def __init__(self, baseline_rad: float, steps: int, omitted: int) -> None:
        self.baseline_rad = baseline_rad
        self._steps, self._omitted = steps, omitted
        self._seen = 0
        self._orientations_rad: list[float] = []

    def add(self, count: int, orientation_rad: float) -> float | None:
        """Add the orientation of the next `count` steps; return the offset when the training is over."""
        self._seen += count
        if self._seen > self._omitted:
            self._orientations_rad.append(orientation_rad)
        if self._seen < self._steps or not self._orientations_rad:
            return None
        mean_rad = calibrated_mean_yaw(np.array(self._orientations_rad))
        return float(wrap_angle(mean_rad - self.baseline_rad))


class MmpdrHeading:
    """Stage Step -> Step that fills in the heading by MMPDR's adaptive offset compensation.

    Parameters
    ----------
    parameters : MmpdrHeadingParams
        Numbers of training steps.
    """

    latency_s = STRIDE_LATENCY_S

    def __init__(self, parameters: MmpdrHeadingParams) -> None:
        self._parameters = parameters
        self._offsets: list[TrainedOffset] = []
        self._strides = StridePairing()
        self._segment: int | None = None
        self._mode: CarryingMode | None = None
        self._moved = False  # since the latest valid step
        self._heading_rad: float | None = None  # of the latest valid step, which becomes O_b
        self._offset_rad = 0.0
        self._training: _Training | None = None

    @property
    def trained_offsets(self) -> tuple[TrainedOffset, ...]:
        """Return the offsets trained so far, in order of time (the paper's Table IX)."""
        return tuple(self._offsets)

    def push(self, item: Step, /) -> list[Step]:
        """Take the next step and return those whose heading is now known."""
        done: list[Step] = []
        if item.event.segment != self._segment:
            done, self._segment = self.flush(), item.event.segment
        if item.event.mode is CarryingMode.TRANS or item.event.compensated:
            return done + self.flush() + self._keep(item)
        mode = self._mode_at(item)
        if mode is not self._mode or self._moved:
            done += self.flush()
            self._change(mode)
        if mode not in _STRIDE_MODES:
            return done + self._orient((item,))
        return done + [step for steps in self._strides.add(item) for step in self._orient(steps)]

    def flush(self) -> list[Step]:
        """Return the step that waits for the second of its pair."""
        return [step for steps in self._strides.flush() for step in self._orient(steps)]

    def _mode_at(self, step: Step) -> CarryingMode:
        if step.event.mode is not CarryingMode.UNKNOWN:
            return step.event.mode
        return self._mode or CarryingMode.HOLDING

    def _keep(self, step: Step) -> list[Step]:
        """Give the heading before to a step of a transition, or to a compensated one."""
        self._moved |= step.event.mode is CarryingMode.TRANS
        heading_rad = self._heading_rad
        if heading_rad is None:
            heading_rad = calibrated_mean_yaw(step.samples.yaw_rad)
        return [replace(step, heading_rad=heading_rad)]

    def _change(self, mode: CarryingMode) -> None:
        self._mode, self._moved = mode, False
        self._offset_rad, self._training = 0.0, None
        if self._heading_rad is None or mode is CarryingMode.HOLDING:
            return
        p = self._parameters
        if mode in _STRIDE_MODES:
            self._training = _Training(self._heading_rad, p.pocket_steps, p.omitted_steps)
        else:
            self._training = _Training(self._heading_rad, p.swing_steps, 0)

    def _orient(self, steps: Sequence[Step]) -> list[Step]:
        """Give some steps, averaged together, their heading."""
        mean_rad = mean_yaw_of(steps)
        if self._training is None:
            self._heading_rad = float(wrap_angle(mean_rad - self._offset_rad))
        else:
            self._heading_rad = self._training.baseline_rad
            self._train(steps, mean_rad)
        return [replace(step, heading_rad=self._heading_rad) for step in steps]

    def _train(self, steps: Sequence[Step], mean_rad: float) -> None:
        if self._training is None or self._mode is None:
            return
        offset_rad = self._training.add(len(steps), mean_rad)
        if offset_rad is not None:
            self._offset_rad, self._training = offset_rad, None
            self._offsets.append(TrainedOffset(steps[-1].event.time_s, self._mode, offset_rad))
