"""The moving trunk of a walker: forward along the path, up and down once a step, side to side once a stride."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.interpolate import PPoly
from scipy.optimize import brentq

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import Fraction, NonNegative, Positive, params
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal, evaluate_curve, quintic_curve
from pdr_est.simulate.walker.step_schedule import SETTLE_S, StepSchedule
from pdr_est.simulate.walker.walking_path import WalkingPath

Side = Literal["left", "right"]

_LEG_SHARE = 0.53  # leg length over body height


@params
class BodyTurn:
    """A stretch in which the body faces another direction than that of the path: sideways or backward walking."""

    start_s: NonNegative
    """Time at which the body begins to turn, s."""
    end_s: Positive
    """Time at which the body begins to turn back, s; at least `duration_s` later."""
    angle_rad: float
    """Direction that the body faces less the direction of the path, rad, counter-clockwise."""
    duration_s: Positive = 1.0
    """Duration of each of the two turns, s."""


@params
class BodyParams:
    """Parameters of the trunk's motion while walking."""

    bounce_share: NonNegative = 0.7
    """Ratio of the trunk's rise and fall to that of a stiff inverted pendulum, L^2 / (8 leg). 0.7 gives 5 cm at a
    step of 0.73 m and, at 1.8 steps a second, 7 m/s^2 from lowest to highest vertical acceleration; real held phones
    show 5 to 12.
    """
    boundary_bounce: Fraction = 0.65
    """Ratio of the rise and fall at the first and last heel strike of a bout to that beside it; really a half to
    three quarters.
    """
    impact: tuple[NonNegative, NonNegative] = (0.3, 0.1)
    """Ratios of the second and third harmonic of the vertical acceleration to the first; they sharpen the peak behind
    the heel strike. Really 0.06 to 0.40 and 0.04 to 0.18.
    """
    peak_phase: Fraction = 0.1
    """Fraction of a step from the heel strike to the trunk's lowest point."""
    speed_ripple: Fraction = 0.06
    """Relative amplitude of the forward speed, which is highest at the heel strike."""
    sway_m: NonNegative = 0.018
    """Amplitude of the sideways motion towards the standing leg, m."""
    turns: tuple[BodyTurn, ...] = ()
    """Stretches of sideways or backward walking, in order of time."""


@dataclass(frozen=True)
class BodyMotion:
    """Motion of the trunk at sampled times.

    Attributes
    ----------
    time_s : Array
        Sampling times, (n,), s.
    on_path : DifferentiableSignal
        Arc length of the point on the path beside the trunk, m.
    east, north : DifferentiableSignal
        Position of the trunk's centre, m.
    up : DifferentiableSignal
        Height of the trunk's centre above its height when standing, m.
    heading : DifferentiableSignal
        Direction that the trunk faces, rad, continuous; the direction of the path but for turns of the body.
    phase : DifferentiableSignal
        Count of steps, a whole number at each heel strike; without meaning while activity is 0.
    activity : DifferentiableSignal
        0 while standing, 1 while walking.
    left_foot_odd : bool
        True if the left foot strikes at the odd counts of phase.
    seated : DifferentiableSignal, optional
        0 while the walker stands or walks, 1 while sitting, where the walker ever sits.
    lean : tuple of DifferentiableSignal, optional
        Rotations of the whole body about its left and its forward axis, rad, where something rocks it.
    """

    time_s: Array
    on_path: DifferentiableSignal
    east: DifferentiableSignal
    north: DifferentiableSignal
    up: DifferentiableSignal
    heading: DifferentiableSignal
    phase: DifferentiableSignal
    activity: DifferentiableSignal
    left_foot_odd: bool
    seated: DifferentiableSignal | None = None
    lean: tuple[DifferentiableSignal, DifferentiableSignal] | None = None

    def stride_of(self, side: Side) -> DifferentiableSignal:
        """Count the strides (two steps) of one leg: a whole number at each heel strike of that leg."""
        odd = self.left_foot_odd == (side == "left")
        return (self.phase + (1.0 if odd else 0.0)) * 0.5

    def select(self, part: slice) -> "BodyMotion":
        """Select the motion at a range of the sampled times."""
        signals = {name: getattr(self, name)[part] for name in _SIGNALS}
        seated = None if self.seated is None else self.seated[part]
        lean = None if self.lean is None else (self.lean[0][part], self.lean[1][part])
        return BodyMotion(left_foot_odd=self.left_foot_odd, seated=seated, lean=lean, **signals)


_SIGNALS = ("time_s", "on_path", "east", "north", "up", "heading", "phase", "activity")


class WalkingBody:
    """Motion of the trunk as an exact function of time."""

    def __init__(self, path: WalkingPath, steps: StepSchedule, height_m: float, parameters: BodyParams) -> None:
        self._path = path
        self._parameters = parameters
        self._left_foot_odd = bool(steps.foot[0] == "L")
        rise_m = parameters.bounce_share * steps.length_m**2 / (8.0 * _LEG_SHARE * height_m)
        self._progress = _progress(steps)
        self._phase = _phase(steps)
        self._activity = _envelope(steps, np.ones(len(steps)))
        self._bounce = _envelope(steps, _softer_at_ends(steps, 0.5 * rise_m, parameters.boundary_bounce))
        ripple_m = parameters.speed_ripple / (2.0 * np.pi) * steps.length_m
        self._ripple = _envelope(steps, ripple_m, to_rest=True)
        self._turned = _body_turns(parameters.turns, steps.end_s) if parameters.turns else None

    def at(self, time_s: Array) -> BodyMotion:
        """Compute the motion at times (n,), s; the body stands still before the first step and after the last."""
        phase = evaluate_curve(self._phase, time_s)
        activity = evaluate_curve(self._activity, time_s)
        angle = phase * (2.0 * np.pi)
        on_path = self._on_path(time_s)
        east, north, heading = self._path.follow(on_path)
        # over the left leg (positive) while it carries the body: between its heel strike and the next one
        towards_left = -1.0 if self._left_foot_odd else 1.0
        sway = activity * (phase * np.pi).sin() * (towards_left * self._parameters.sway_m)
        return BodyMotion(
            time_s=time_s,
            on_path=on_path,
            east=east - sway * heading.sin(),
            north=north + sway * heading.cos(),
            up=evaluate_curve(self._bounce, time_s) * self._rise(angle),
            heading=heading if self._turned is None else heading + evaluate_curve(self._turned, time_s),
            phase=phase,
            activity=activity,
            left_foot_odd=self._left_foot_odd,
        )

    def on_path_at(self, time_s: Array) -> tuple[Array, Array]:
        """Compute position (n, 2), m, and direction (n,), rad, of the point on the path beside the trunk."""
        points = self._path.at(self._on_path(np.asarray(time_s, dtype=np.float64)).value)
        return points.position_m, points.heading_rad

    def time_at(self, arc_length_m: Array) -> Array:
        """Find when the trunk passes points of the path, s, for arc lengths (n,), m, strictly inside the path."""
        first_s, last_s = float(self._progress.x[0]), float(self._progress.x[-1])
        return np.array([brentq(self._past, first_s, last_s, args=(float(arc),)) for arc in arc_length_m])

    def _past(self, time_s: float, arc_length_m: float) -> float:
        return float(self._on_path(np.asarray(time_s)).value) - arc_length_m

    def _on_path(self, time_s: Array) -> DifferentiableSignal:
        angle = evaluate_curve(self._phase, time_s) * (2.0 * np.pi)
        return evaluate_curve(self._progress, time_s) + evaluate_curve(self._ripple, time_s) * angle.sin()

    def _rise(self, angle: DifferentiableSignal) -> DifferentiableSignal:
        """Compute the height over its amplitude.

        Harmonics are divided by their squared order to act on the acceleration.
        """
        second, third = self._parameters.impact
        lowest = angle - 2.0 * np.pi * self._parameters.peak_phase
        return -(lowest.cos() + (lowest * 2.0).cos() * (second / 4.0) + (lowest * 3.0).cos() * (third / 9.0))


def _body_turns(turns: tuple[BodyTurn, ...], end_s: float) -> PPoly:
    """Compute the direction that the body faces less that of the path over time."""
    nodes = _Nodes()
    last_s = -np.inf
    for turn in turns:
        if turn.start_s < last_s or turn.end_s < turn.start_s + turn.duration_s:
            raise ConfigError(
                f"body turn at {turn.start_s} s: turns follow each other, and each ends at least its duration "
                f"({turn.duration_s} s) after its start: move its times"
            )
        last_s = turn.end_s + turn.duration_s
        edge_s = np.array([turn.start_s, turn.start_s + turn.duration_s, turn.end_s, last_s])
        nodes.add(edge_s, np.array([0.0, turn.angle_rad, turn.angle_rad, 0.0]), np.zeros(4))
    return nodes.curve(end_s)


def _progress(steps: StepSchedule) -> PPoly:
    """Compute the mean arc length over time: each step covers its length, with standstills between the bouts."""
    nodes = _Nodes()
    covered_m = 0.0
    for bout in steps.bouts:
        edge_s = _edges(steps, bout)
        arc_m = covered_m + np.concatenate([[0.0], np.cumsum(steps.length_m[bout])])
        speed = np.diff(arc_m) / np.diff(edge_s)
        nodes.add(edge_s, arc_m, np.concatenate([[0.0], 0.5 * (speed[1:] + speed[:-1]), [0.0]]))
        covered_m = float(arc_m[-1])
    return nodes.curve(steps.end_s)


def _phase(steps: StepSchedule) -> PPoly:
    """Count steps over time; a bout begins in the middle of a step, where the trunk is highest, as in standing.

    After a bout the count falls back while the walker stands, which no motion shows.
    """
    nodes = _Nodes()
    for bout in steps.bouts:
        edge_s = _edges(steps, bout)
        count = np.arange(bout.start, bout.stop + 1, dtype=np.float64)
        count[0] += 0.5
        rate = 1.0 / np.diff(edge_s)
        at_edge = np.concatenate([[0.0], 0.5 * (rate[1:] + rate[:-1]), rate[-1:]])
        nodes.add(edge_s, count, at_edge)
        nodes.add(edge_s[-1:] + SETTLE_S, bout.stop + rate[-1:] * SETTLE_S, rate[-1:])
    return nodes.curve(steps.end_s)


def _envelope(steps: StepSchedule, amplitude: Array, to_rest: bool = False) -> PPoly:
    """Compute an amplitude over time.

    It rises in the first step of a bout, then passes through that of each step at its heel strike, and fades out
    after the last one (`to_rest`: already with the last one).
    """
    nodes = _Nodes()
    for bout in steps.bouts:
        level = np.concatenate([[0.0], amplitude[bout], [0.0]])
        if to_rest:
            level[-2] = 0.0
        edge_s = _edges(steps, bout)
        nodes.add(np.append(edge_s, edge_s[-1] + SETTLE_S), level, np.zeros(len(level)))
    return nodes.curve(steps.end_s)


def _softer_at_ends(steps: StepSchedule, amplitude: Array, share: float) -> Array:
    """Take the amplitudes of the first and last step of each bout from their inner neighbours, by a share."""
    softened = amplitude.copy()
    for bout in steps.bouts:
        if bout.stop - bout.start > 2:
            softened[[bout.start, bout.stop - 1]] = share * amplitude[[bout.start + 1, bout.stop - 2]]
    return softened


def _edges(steps: StepSchedule, bout: slice) -> Array:
    """Return the beginning of a bout and the ends of its steps, (n + 1,)."""
    return np.append(steps.start_s[bout.start], steps.time_s[bout])


class _Nodes:
    """Points that a curve of time passes through, standing still before and after them."""

    def __init__(self) -> None:
        self._columns: list[tuple[Array, Array, Array]] = []

    def add(self, time_s: Array, value: Array, rate: Array) -> None:
        self._columns.append((time_s, value, rate))

    def curve(self, end_s: float) -> PPoly:
        time_s, value, rate = (np.concatenate(parts) for parts in zip(*self._columns, strict=True))
        before, after = min(0.0, time_s[0]) - 1.0, max(end_s, time_s[-1]) + 1.0
        return quintic_curve(
            np.concatenate([[before], time_s, [after]]),
            np.concatenate([value[:1], value, value[-1:]]),
            np.concatenate([[0.0], rate, [0.0]]),
        )
