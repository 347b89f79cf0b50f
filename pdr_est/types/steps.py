"""Steps."""

from dataclasses import dataclass
from enum import IntEnum

from pdr_est.types.sensors import LevelBlock


class CarryingMode(IntEnum):
    """How the phone is carried (MMPDR section III-A; OTHER is bag, belt, ear, armband)."""

    UNKNOWN = 0
    HOLDING = 1
    SWING = 2
    POCKET = 3
    OTHER = 4
    TRANS = 5


class Gait(IntEnum):
    """How the walker moves on foot."""

    UNKNOWN = 0
    WALKING = 1
    JOGGING = 2
    RUNNING = 3


@dataclass(frozen=True)
class StepEvent:
    """A detected step: when the detector's feature happened, not when it was recognised.

    mode_probability: how sure the recogniser was of the mode at the step. compensated: nobody saw the step; its time
    is made up from the rhythm before it.
    """

    index: int
    time_s: float
    segment: int
    mode: CarryingMode
    confidence: float = 1.0
    mode_probability: float = 1.0
    compensated: bool = False


@dataclass(frozen=True)
class Step:
    """A step on its way through the front end; length and heading are NaN until their stage has run.

    start_s: when the movement of this step began. frequency_hz: reciprocal of the time since the previous
    step, 0 for the first step after a standstill (MMPDR section III-C). samples: from start to the event.
    heading_rad: direction of the step as the heading stage found it, arbitrary zero per segment. sigma_turn_rad: of
    the change of heading since the step before, beyond what every step has. follows_phone: whether the heading stage
    tells with it where the phone was turned against the body; else a change of the mode may have. recorded_share: of
    the movement, less than 1 for a step that had begun before the segment. path_heading_rad,
    sigma_path_heading_rad: heading of the straight path that the step lies on, with the same zero, and its standard
    deviation; NaN where no such path is known.
    gait_probability: of walking, jogging and running; NaN where gait is UNKNOWN. sigma_length_m: of the length,
    independent from step to step.
    """

    event: StepEvent
    start_s: float
    frequency_hz: float
    samples: LevelBlock
    length_m: float = float("nan")
    heading_rad: float = float("nan")
    sigma_turn_rad: float = 0.0
    follows_phone: bool = False
    path_heading_rad: float = float("nan")
    sigma_path_heading_rad: float = float("nan")
    gait: Gait = Gait.UNKNOWN
    gait_probability: tuple[float, float, float] = (float("nan"), float("nan"), float("nan"))
    sigma_length_m: float = float("nan")
    recorded_share: float = 1.0


def begins_walk(step: Step, previous: Step | None) -> bool:
    """Whether a step says nothing about the one before: after a standstill, a gap, or at the very beginning."""
    return previous is None or step.frequency_hz == 0.0 or step.event.segment != previous.event.segment
