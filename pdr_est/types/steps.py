"""Carrying modes, gaits, and the steps that the front end detects."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

from pdr_est.types.sensors import Hole, LevelBlock

LONGEST_STEP_S = 1.0
"""Time, s, longer than a step of a walker takes: who makes no step in it stands."""


class CarryingMode(IntEnum):
    """The way a phone is carried (MMPDR section III-A)."""

    UNKNOWN = 0
    """Not recognised."""

    HOLDING = 1
    """Held in front of the body."""

    SWING = 2
    """In the hand of a swinging arm."""

    POCKET = 3
    """In a trouser pocket."""

    OTHER = 4
    """In a bag, on a belt, at the ear, on an armband."""

    TRANS = 5
    """Moving from one placement to another."""


class Gait(IntEnum):
    """The way a person moves on foot."""

    UNKNOWN = 0
    WALKING = 1
    JOGGING = 2
    RUNNING = 3


@dataclass(frozen=True)
class StepEvent:
    """A detected step, stamped with the time of the signal feature that marks it.

    Attributes
    ----------
    index
        Sample of the feature on the working grid.
    time_s
        Time of the feature, s; not the time at which it was recognised.
    segment
        Segment of the recording.
    mode
        Carrying mode at the step.
    confidence
        Confidence of the detector, 0 to 1.
    mode_probability
        Probability of `mode`.
    compensated
        True for a step that was not observed: it is inserted at the rhythm of the steps before it, or in the middle
        between two steps.
    """

    index: int
    time_s: float
    segment: int
    mode: CarryingMode
    confidence: float = 1.0
    mode_probability: float = 1.0
    compensated: bool = False


@dataclass(frozen=True)
class TurnHypothesis:
    """One possible heading change of a step before which the phone was put elsewhere on the body.

    Attributes
    ----------
    probability
        Probability of the hypothesis before any other measurement; those of a step add up to 1.
    heading_change_rad
        Heading change since the previous step, rad, counter-clockwise.
    sigma_rad
        Standard deviation of the heading change, rad.
    origin
        What suggests it, in words, such as "straight on" or "principal axis".
    """

    probability: float
    heading_change_rad: float
    sigma_rad: float
    origin: str


@dataclass(frozen=True)
class StepMotion:
    """Posture and acceleration of a phone during a step, in the level frame that its yaw counts in.

    Attributes
    ----------
    up
        Mean unit vector upwards in device axes; zeros without samples.
    east, north
        East and north components of each of the three device axes, summed over the samples.
    leading_mps2
        East and north component of the acceleration that is ahead of the vertical one by a quarter of a step, m/s²; 0
        for a step with too few samples.
    bounce_mps2
        Root mean square of the vertical acceleration without gravity, m/s²; 0 without samples.
    """

    up: tuple[float, float, float]
    east: tuple[float, float, float]
    north: tuple[float, float, float]
    leading_mps2: tuple[float, float]
    bounce_mps2: float


@dataclass(frozen=True)
class Step:
    """A step on its way through the front end; length and heading are NaN until their stages have run.

    Attributes
    ----------
    event
        Time, mode and confidence of the detection.
    start_s
        Start of the movement, s.
    frequency_hz
        Reciprocal of the time since the previous step; 0 for the first step after a standstill (MMPDR section
        III-C).
    samples
        Samples from the start of the movement to the event.
    length_m
        Step length, m.
    heading_rad
        Heading of the step, rad, with an arbitrary zero.
    holes
        Gaps of the recording since the previous step.
    motion
        Posture and acceleration of the phone, for stages that need them after the heading stage; None where that has
        not computed them.
    sigma_turn_rad
        Standard deviation of the heading change since the previous step, rad, in addition to the noise that every
        step has.
    turn_hypotheses
        Possible heading changes since the previous step, where the phone was put elsewhere before the step and the
        heading stage cannot tell how far the walker turned meanwhile; the most probable one is the change to
        `heading_rad`. Empty for any other step.
    placement_tracked
        True when the heading stage itself accounts for rotations of the phone against the body; otherwise a change
        of the carrying mode adds to the uncertainty of the heading.
    course_offset_rad
        Direction in which the walker moves less the direction ahead of the body, rad; contained in `heading_rad`, and
        not 0 for sideways and backward walking only.
    sigma_course_rad
        Standard deviation of `course_offset_rad`, rad; the error is common to the steps of a stretch.
    path_heading_rad, sigma_path_heading_rad
        Heading of the straight path that the step lies on, with the same zero, and its standard deviation, rad; NaN
        where no such path is known.
    gait
        Recognised gait.
    gait_probability
        Probabilities of walking, jogging and running; NaN while `gait` is UNKNOWN.
    sigma_length_m
        Standard deviation of the length, m, independent from step to step.
    stairs_probability
        Probability that the step lies on stairs, as far as the length takes it into account.
    recorded_share
        Recorded fraction of the movement; less than 1 for a step that began before its segment.
    """

    event: StepEvent
    start_s: float
    frequency_hz: float
    samples: LevelBlock
    length_m: float = float("nan")
    heading_rad: float = float("nan")
    sigma_turn_rad: float = 0.0
    turn_hypotheses: tuple[TurnHypothesis, ...] = ()
    placement_tracked: bool = False
    course_offset_rad: float = 0.0
    sigma_course_rad: float = 0.0
    path_heading_rad: float = float("nan")
    sigma_path_heading_rad: float = float("nan")
    gait: Gait = Gait.UNKNOWN
    gait_probability: tuple[float, float, float] = (float("nan"), float("nan"), float("nan"))
    sigma_length_m: float = float("nan")
    stairs_probability: float = 0.0
    recorded_share: float = 1.0
    holes: tuple[Hole, ...] = ()
    motion: StepMotion | None = None

    @property
    def time_s(self) -> float:
        """Time of the detected signal feature, s."""
        return self.event.time_s

    @property
    def mode(self) -> CarryingMode:
        """Carrying mode at the step."""
        return self.event.mode


def begins_walk(step: Step, previous: Step | None) -> bool:
    """Tell whether a step starts a new sequence: no step before it, a standstill before it, or a new segment."""
    return previous is None or step.frequency_hz == 0.0 or step.event.segment != previous.event.segment


def walks_begun(steps: Sequence[Step], previous: Step | None) -> list[bool]:
    """Tell for each of some successive steps what `begins_walk` tells; `previous` is the one before the first."""
    if previous is None:
        return [True, *walks_begun(steps[1:], steps[0])] if steps else []
    segment, found = previous.event.segment, []
    for step in steps:
        before, segment = segment, step.event.segment
        found.append(step.frequency_hz == 0.0 or segment != before)
    return found
