"""The path of a walker: a polyline whose corners are rounded, parametrised by its arc length.

Circular arcs would make the curvature jump, and with it the centripetal acceleration of the walker. Here the heading
in a corner follows a quintic smooth step of the arc length, so that the curvature and its slope are continuous. The
heading is an exact polynomial; the position is its integral, by Gauss-Legendre quadrature whose error is below
rounding.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.frames import Array, rotate_vectors, wrap_angle
from pdr_est.params import Positive, params
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal

PEAK_SLOPE = 1.875  # of the smooth step, in its middle: mean over least radius of a corner
_LARGEST_TURN_RAD = np.deg2rad(170.0)  # beyond it the rounding would cut off most of the legs
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


@params
class PathParams:
    """Parameters of a path."""

    vertices_m: tuple[tuple[float, float], ...]
    """Vertices (east, north) of the polyline, m."""
    corner_radius_m: Positive = 0.8
    """Least radius of curvature in each corner, m."""
    corner_radii_m: tuple[Positive, ...] | None = None
    """Least radius of curvature of each corner instead, m; None takes corner_radius_m for all."""


@dataclass(frozen=True)
class PathPoints:
    """Points of a path.

    Attributes
    ----------
    position_m : Array
        East and north, (n, 2), m.
    heading_rad : Array
        Direction of the path, (n,), rad, continuous, not wrapped.
    curvature_pm : Array
        Curvature, (n,), 1/m, positive in left turns.
    curvature_slope_pm2 : Array
        Derivative of the curvature by the arc length, (n,), 1/m^2.
    """

    position_m: Array
    heading_rad: Array
    curvature_pm: Array
    curvature_slope_pm2: Array


class WalkingPath:
    """Polyline with rounded corners; straight beyond both ends.

    Attributes
    ----------
    length_m : float
        Exact arc length, m.
    corner_m : Array
        Arc length at the middle of each corner, (c,), m.
    turn_rad : Array
        Heading change of each corner, (c,), rad, left positive.
    """

    def __init__(self, parameters: PathParams) -> None:
        """Build the path.

        Raises
        ------
        ConfigError
            If a leg is too short for the corners at its ends or the path turns back on itself.
        """
        vertices = np.asarray(parameters.vertices_m, dtype=np.float64)
        if vertices.ndim != 2 or len(vertices) < 2:
            raise ConfigError(f"vertices_m: {len(vertices)} vertices: a path needs at least 2")
        legs = np.diff(vertices, axis=0)
        leg_m = np.hypot(*legs.T)
        if not leg_m.all():
            raise ConfigError(f"vertices_m: vertex {int(np.argmin(leg_m)) + 2} repeats the one before it: remove it")
        leg_heading = np.arctan2(legs[:, 1], legs[:, 0])
        turn = wrap_angle(np.diff(leg_heading))
        _check_turns(turn)
        corner_m = PEAK_SLOPE * _radii(parameters, len(turn)) * np.abs(turn)
        cut_m = _cut_off(turn, corner_m)
        straight_m = leg_m - np.concatenate([[0.0], cut_m]) - np.concatenate([cut_m, [0.0]])
        _check_legs(straight_m, leg_m)

        # pieces alternate: leg, corner, leg, ..., leg
        self._piece_m = _alternate(straight_m, corner_m)
        self._turn = _alternate(np.zeros(len(straight_m)), turn)
        self._start_m = np.concatenate([[0.0], np.cumsum(self._piece_m)[:-1]])
        self._heading = leg_heading[0] + np.concatenate([[0.0], np.cumsum(self._turn)[:-1]])
        ends = _local_end(self._piece_m, self._turn, np.ones(len(self._piece_m)))
        moves = rotate_vectors(ends, self._heading)
        self._origin = vertices[0] + np.concatenate([np.zeros((1, 2)), np.cumsum(moves, axis=0)[:-1]])
        self.length_m = float(self._piece_m.sum())
        self.corner_m: Array = self._start_m[1::2] + corner_m / 2.0
        self.turn_rad: Array = turn

    def at(self, arc_length_m: Array) -> PathPoints:
        """Compute the points at arc lengths (n,), m."""
        arc = np.asarray(arc_length_m, dtype=np.float64)
        piece = np.clip(np.searchsorted(self._start_m, arc, side="right") - 1, 0, len(self._start_m) - 1)
        length, turn = self._piece_m[piece], self._turn[piece]
        share = (arc - self._start_m[piece]) / np.where(length > 0.0, length, 1.0)
        per_m = np.where(length > 0.0, 1.0 / np.where(length > 0.0, length, 1.0), 0.0)
        local = np.stack([arc - self._start_m[piece], np.zeros(len(arc))], axis=1)
        bent = turn != 0.0
        local[bent] = _local_end(length[bent], turn[bent], share[bent])
        return PathPoints(
            position_m=self._origin[piece] + rotate_vectors(local, self._heading[piece]),
            heading_rad=self._heading[piece] + np.where(bent, turn * _smooth_step(share), 0.0),
            curvature_pm=np.where(bent, turn * _smooth_step_slope(share) * per_m, 0.0),
            curvature_slope_pm2=np.where(bent, turn * _smooth_step_bend(share) * per_m**2, 0.0),
        )

    def follow(
        self, arc_length: DifferentiableSignal
    ) -> tuple[DifferentiableSignal, DifferentiableSignal, DifferentiableSignal]:
        """Compute east (m), north (m) and heading (rad) of a point that moves along the path."""
        points = self.at(arc_length.value)
        cosine, sine = np.cos(points.heading_rad), np.sin(points.heading_rad)
        return (
            arc_length.chain_rule(points.position_m[:, 0], cosine, -sine * points.curvature_pm),
            arc_length.chain_rule(points.position_m[:, 1], sine, cosine * points.curvature_pm),
            arc_length.chain_rule(points.heading_rad, points.curvature_pm, points.curvature_slope_pm2),
        )


def _radii(parameters: PathParams, corners: int) -> Array:
    if parameters.corner_radii_m is None:
        return np.full(corners, parameters.corner_radius_m)
    if len(parameters.corner_radii_m) != corners:
        raise ConfigError(
            f"corner_radii_m: {len(parameters.corner_radii_m)} radii for {corners} corners: give one for each vertex "
            "between the first and the last"
        )
    return np.array(parameters.corner_radii_m)


def _smooth_step(u: Array) -> Array:
    return u**3 * (10.0 - 15.0 * u + 6.0 * u**2)


def _smooth_step_slope(u: Array) -> Array:
    return 30.0 * u**2 * (1.0 - u) ** 2


def _smooth_step_bend(u: Array) -> Array:
    return 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)


def _local_end(length_m: Array, turn_rad: Array, share: Array) -> Array:
    """Integrate (cos, sin) of the heading: position (n, 2) at a share of pieces, in the frame of their beginning."""
    u = 0.5 * share[:, None] * (_NODES + 1.0)
    angle = turn_rad[:, None] * _smooth_step(u)
    scale = 0.5 * share * length_m
    end: Array = scale[:, None] * np.stack([np.cos(angle) @ _WEIGHTS, np.sin(angle) @ _WEIGHTS], axis=1)
    return end


def _cut_off(turn_rad: Array, corner_m: Array) -> Array:
    """Compute how far before and behind a vertex its corner begins and ends: half the chord, projected on the leg."""
    chord = np.hypot(*_local_end(corner_m, turn_rad, np.ones(len(turn_rad))).T)
    cut: Array = 0.5 * chord / np.cos(turn_rad / 2.0)
    return cut


def _alternate(legs: Array, corners: Array) -> Array:
    pieces = np.empty(len(legs) + len(corners))
    pieces[0::2], pieces[1::2] = legs, corners
    return pieces


def _check_turns(turn_rad: Array) -> None:
    for corner, turn in enumerate(turn_rad, start=2):
        if abs(turn) > _LARGEST_TURN_RAD:
            raise ConfigError(
                f"vertices_m: the path turns by {np.degrees(turn):.0f} degrees at vertex {corner}: "
                f"at most {np.degrees(_LARGEST_TURN_RAD):.0f} can be rounded, so add a vertex beside it"
            )


def _check_legs(straight_m: Array, leg_m: Array) -> None:
    for leg, (straight, length) in enumerate(zip(straight_m, leg_m, strict=True), start=1):
        if straight < 0.0:
            raise ConfigError(
                f"corner_radius_m: the corners of the {length:.2f} m leg behind vertex {leg} need "
                f"{length - straight:.2f} m: lengthen the leg or take a smaller radius"
            )
