"""The moving trunk of a walker: forward along the path, up and down once a step, side to side once a stride.

Runners leave the ground in each step (`running_bounce`). On stairs the trunk rises or falls by a tread's height in
each step, and swings about that: upwards with a vertical force of at most 1.3 body weights, downwards with a landing
of 1.4 to 1.6 (Riener et al. 2002, Stacoff et al. 2005).

References
----------
Novacheck 1998, Gait and Posture 7. Riener, Rabuffetti and Frigo 2002, Gait and Posture 15. Stacoff et al. 2005, Gait
and Posture 21.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.interpolate import PPoly
from scipy.optimize import brentq

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import Fraction, NonNegative, Positive, params
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal, evaluate_curve
from pdr_est.simulate.walker.running_bounce import RunningBounce
from pdr_est.simulate.walker.step_curves import CurveNodes, amplitude_curve, cumulative_curve, step_count_curve
from pdr_est.simulate.walker.step_schedule import StepSchedule
from pdr_est.simulate.walker.walking_path import WalkingPath

Side = Literal["left", "right"]

_LEG_SHARE = 0.53  # leg length over body height
_RUN_SWAY = 0.4  # sideways motion of runners over that of walkers: their feet follow a line, ours


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
    run_activity: Positive = 1.0
    """Ratio of the motion of arms, legs and hands in running to that in walking; it is quicker all the same, because
    steps follow sooner. The hip moves through 60 degrees in running and 40 in walking (Novacheck 1998), but phones in
    16 pockets of MotionSense tilt no further in jogging than this gives, and turn up and down once a stride by less.
    """
    stair_activity: tuple[Positive, Positive] = (1.2, 0.9)
    """The same ratio on stairs, upwards and downwards, from the tilts of the phones in 4 pockets of MotionSense; the
    hip bends far in climbing and little in descending (Riener et al. 2002).
    """
    stair_bounce: tuple[NonNegative, NonNegative] = (0.13, 0.18)
    """Ratios of the amplitude of the trunk's swing on stairs to the height of a tread, upwards and downwards."""
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
        0 while standing, 1 while walking, another in running and on stairs: the scale of the limbs' motion.
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
        running = steps.flight_s > 0.0
        self._progress = cumulative_curve(steps, steps.length_m)
        self._climb = cumulative_curve(steps, steps.rise_m)
        self._phase = step_count_curve(steps)
        self._activity = amplitude_curve(steps, _limb_activity(steps, parameters))
        self._lean = amplitude_curve(steps, np.where(running, _RUN_SWAY, 1.0))
        self._bounce = amplitude_curve(steps, _bounce_m(steps, height_m, parameters))
        self._running = RunningBounce(steps, self._walking_rise)
        ripple_m = parameters.speed_ripple / (2.0 * np.pi) * steps.length_m
        self._ripple = amplitude_curve(steps, ripple_m, to_rest=True)
        self._turned = _body_turns(parameters.turns, steps.end_s) if parameters.turns else None

    def at(self, time_s: Array) -> BodyMotion:
        """Compute the motion at times (n,), s; the body stands still before the first step and after the last."""
        phase = evaluate_curve(self._phase, time_s)
        on_path = self._on_path(time_s)
        east, north, heading = self._path.follow(on_path)
        # over the left leg (positive) while it carries the body: between its heel strike and the next one
        towards_left = -1.0 if self._left_foot_odd else 1.0
        sway = evaluate_curve(self._lean, time_s) * (phase * np.pi).sin() * (towards_left * self._parameters.sway_m)
        return BodyMotion(
            time_s=time_s,
            on_path=on_path,
            east=east - sway * heading.sin(),
            north=north + sway * heading.cos(),
            up=self._running.replace_in(self._walking_rise(time_s), time_s) + evaluate_curve(self._climb, time_s),
            heading=heading if self._turned is None else heading + evaluate_curve(self._turned, time_s),
            phase=phase,
            activity=evaluate_curve(self._activity, time_s),
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

    def _walking_rise(self, time_s: Array) -> DifferentiableSignal:
        """Compute the height above that of standing in walking, without climbing.

        Harmonics are divided by their squared order to act on the acceleration.
        """
        second, third = self._parameters.impact
        lowest = evaluate_curve(self._phase, time_s) * (2.0 * np.pi) - 2.0 * np.pi * self._parameters.peak_phase
        shape = -(lowest.cos() + (lowest * 2.0).cos() * (second / 4.0) + (lowest * 3.0).cos() * (third / 9.0))
        return evaluate_curve(self._bounce, time_s) * shape


def _limb_activity(steps: StepSchedule, parameters: BodyParams) -> Array:
    """Compute the scale of the limbs' motion at each heel strike, (n,), 1 in walking."""
    upwards, downwards = parameters.stair_activity
    on_stairs = np.where(steps.rise_m > 0.0, upwards, downwards)
    return np.where(steps.flight_s > 0.0, parameters.run_activity, np.where(steps.rise_m == 0.0, 1.0, on_stairs))


def _bounce_m(steps: StepSchedule, height_m: float, parameters: BodyParams) -> Array:
    """Compute the amplitude of the trunk's rise and fall at each heel strike, (n,), m."""
    upwards, downwards = parameters.stair_bounce
    level_m = 0.5 * parameters.bounce_share * steps.length_m**2 / (8.0 * _LEG_SHARE * height_m)
    on_stairs_m = np.where(steps.rise_m > 0.0, upwards, -downwards) * steps.rise_m
    walked_m = np.where(steps.rise_m == 0.0, level_m, on_stairs_m)
    amplitude_m = np.where(steps.flight_s > 0.0, 0.0, walked_m)  # RunningBounce takes the place of running steps
    for bout in steps.bouts:
        if bout.stop - bout.start > 2:
            ends, inner = [bout.start, bout.stop - 1], [bout.start + 1, bout.stop - 2]
            amplitude_m[ends] = parameters.boundary_bounce * amplitude_m[inner]
    return amplitude_m


def _body_turns(turns: tuple[BodyTurn, ...], end_s: float) -> PPoly:
    """Compute the direction that the body faces less that of the path over time."""
    nodes = CurveNodes()
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
