"""Rigid alignments of a track to the truth: rotation and translation, never a scale and never a reflection."""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array, rotation_matrix

LEAST_DIRECTION_DISTANCE_M = 20.0


@dataclass(frozen=True)
class RigidTransform:
    """Rotation by rotation_rad counter-clockwise about the origin, then translation by translation_m (2,)."""

    rotation_rad: float
    translation_m: Array

    def apply(self, points_m: Array) -> Array:
        """Transformed points; points_m: (n, 2)."""
        moved: Array = points_m @ rotation_matrix(self.rotation_rad).T + self.translation_m
        return moved


def best_alignment(track_m: Array, truth_m: Array) -> RigidTransform:
    """The transform of track_m that makes the sum of squared distances to truth_m least; both (n, 2), paired.

    In the plane the optimum over rotations is in closed form: the sum of squares is least where
    sum of dot products * cos(angle) + sum of cross products * sin(angle) is greatest.
    """
    track_mean, truth_mean = track_m.mean(axis=0), truth_m.mean(axis=0)
    a, b = track_m - track_mean, truth_m - truth_mean
    dot = float((a * b).sum())
    cross = float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())
    return _rotate_then_match(float(np.arctan2(cross, dot)), track_mean, truth_mean)


def start_alignment(track_m: Array, truth_m: Array) -> RigidTransform:
    """The transform that matches the first points and the direction from there to `direction_point`.

    track_m, truth_m: (n, 2), paired. A track that has not moved by then is taken to point east.
    """
    k = direction_point(truth_m)
    track_x, track_y = track_m[k] - track_m[0]
    truth_x, truth_y = truth_m[k] - truth_m[0]
    rotation = float(np.arctan2(truth_y, truth_x) - np.arctan2(track_y, track_x))
    return _rotate_then_match(rotation, track_m[0], truth_m[0])


def direction_point(truth_m: Array) -> int:
    """Index of the first truth point at least 20 m away from the first one, else of the farthest one.

    Nearer points are too noisy to set a direction. truth_m: (n, 2).
    """
    distance = np.linalg.norm(truth_m - truth_m[0], axis=1)
    far = np.flatnonzero(distance >= LEAST_DIRECTION_DISTANCE_M)
    return int(far[0]) if len(far) else int(np.argmax(distance))


def _rotate_then_match(rotation_rad: float, track_point_m: Array, truth_point_m: Array) -> RigidTransform:
    translation: Array = truth_point_m - rotation_matrix(rotation_rad) @ track_point_m
    return RigidTransform(rotation_rad, translation)
