"""Rigid alignment of a track to the truth: rotation and translation, without scale and reflection."""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array, rotation_matrix

LEAST_DIRECTION_DISTANCE_M = 20.0


@dataclass(frozen=True)
class RigidTransform:
    """Rotation about the origin, then translation.

    Attributes
    ----------
    rotation_rad : float
        Rotation, rad, counter-clockwise.
    translation_m : ndarray
        Translation (2,), m.
    """

    rotation_rad: float
    translation_m: Array

    def apply(self, points_m: Array) -> Array:
        """Transform points (n, 2), m."""
        moved: Array = points_m @ rotation_matrix(self.rotation_rad).T + self.translation_m
        return moved


def best_alignment(track_m: Array, truth_m: Array) -> RigidTransform:
    """Compute the transform of track_m that minimises the sum of squared distances to truth_m; both (n, 2), paired.

    In the plane the best rotation has a closed form: the sum of squares is least at the angle where
    sum of dot products * cos(angle) + sum of cross products * sin(angle) is greatest.
    """
    track_mean, truth_mean = track_m.mean(axis=0), truth_m.mean(axis=0)
    a, b = track_m - track_mean, truth_m - truth_mean
    dot = float((a * b).sum())
    cross = float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())
    return _rotate_then_match(float(np.arctan2(cross, dot)), track_mean, truth_mean)


def start_alignment(track_m: Array, truth_m: Array) -> RigidTransform:
    """Compute the transform that matches the first points and the direction from there to `direction_point`.

    The points track_m and truth_m, (n, 2), are paired. A track that has not moved by then counts as pointing east.
    """
    k = direction_point(truth_m)
    track_x, track_y = track_m[k] - track_m[0]
    truth_x, truth_y = truth_m[k] - truth_m[0]
    rotation = float(np.arctan2(truth_y, truth_x) - np.arctan2(track_y, track_x))
    return _rotate_then_match(rotation, track_m[0], truth_m[0])


def direction_point(truth_m: Array) -> int:
    """Return the index of the first true position (n, 2) at least 20 m away from the first one, else the farthest.

    Nearer points are too noisy to define a direction.
    """
    distance = np.linalg.norm(truth_m - truth_m[0], axis=1)
    far = np.flatnonzero(distance >= LEAST_DIRECTION_DISTANCE_M)
    return int(far[0]) if len(far) else int(np.argmax(distance))


def _rotate_then_match(rotation_rad: float, track_point_m: Array, truth_point_m: Array) -> RigidTransform:
    translation: Array = truth_point_m - rotation_matrix(rotation_rad) @ track_point_m
    return RigidTransform(rotation_rad, translation)
