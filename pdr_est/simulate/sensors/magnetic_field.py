"""The magnetic field along a walk: that of the Earth, and magnetised bodies beside the path."""

from typing import Annotated

import numpy as np
from annotated_types import Ge, Le

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import NonNegative, Positive, params
from pdr_est.simulate.walker.walking_path import WalkingPath

_UT_PER_DIPOLE = 0.1  # mu_0 / 4 pi in uT m^3 / (A m^2)


@params
class EarthField:
    """Magnetic field of the Earth."""

    strength_ut: NonNegative = 49.0
    """Magnitude of the field, uT."""
    inclination_rad: Annotated[float, Ge(-np.pi / 2), Le(np.pi / 2)] = 1.15
    """Inclination below the horizontal, rad."""
    declination_rad: float = 0.05
    """Direction of magnetic north, rad, clockwise from true north (the map's y axis)."""

    @property
    def vector_ut(self) -> Array:
        """Return the field (3,) in uT: east, north, up."""
        level = self.strength_ut * np.cos(self.inclination_rad)
        east, north = level * np.sin(self.declination_rad), level * np.cos(self.declination_rad)
        return np.array([east, north, -self.strength_ut * np.sin(self.inclination_rad)])


@params
class MagneticDipole:
    """Magnetised body (iron, for example) beside the path."""

    at_m: float
    """Arc length of the point on the path beside it, m."""
    left_m: float = 1.5
    """Distance to the left of the path, m."""
    up_m: float = -0.5
    """Height above the trunk's centre, m."""
    moment_am2: tuple[float, float, float] = (0.0, 0.0, 100.0)
    """Magnetic moment east, north, up, A m^2; 100 A m^2 disturb the field by 10 uT at a distance of 1 m."""
    size_m: Positive = 0.5
    """Radius within which the field grows no more, m."""


def scatter_dipoles(path: WalkingPath, spacing_m: float, seed: int) -> tuple[MagneticDipole, ...]:
    """Draw magnetised bodies along a path through a building: columns, reinforcement, furniture.

    Each lies 1 to 3 m beside the path, left or right, from the floor (1 m below the trunk's centre) to as high above,
    and is magnetised in any direction by 100 A m^2 at the median, half to twice that as a rule. The numbers are our
    choice.

    Parameters
    ----------
    path : WalkingPath
        Path that they lie beside.
    spacing_m : float
        Mean distance between them along the path, m.
    seed : int
        Seed of the draw.

    Raises
    ------
    ConfigError
        If spacing_m is not positive.
    """
    if not spacing_m > 0.0:
        raise ConfigError(f"irons every {spacing_m} m: must be positive")
    rng = np.random.default_rng(seed)
    count = round(path.length_m / spacing_m)
    at_m = np.sort(rng.uniform(0.0, path.length_m, count))
    beside_m = rng.uniform(1.0, 3.0, count) * rng.choice([-1.0, 1.0], count)
    up_m = rng.uniform(-1.0, 1.0, count)
    direction = rng.standard_normal((count, 3))
    strength_am2 = 100.0 * np.exp(0.7 * rng.standard_normal(count))
    moment = direction * (strength_am2 / np.linalg.norm(direction, axis=1))[:, None]
    return tuple(
        MagneticDipole(at_m=float(at), left_m=float(left), up_m=float(up), moment_am2=(float(x), float(y), float(z)))
        for at, left, up, (x, y, z) in zip(at_m, beside_m, up_m, moment, strict=True)
    )


def magnetic_field_ut(
    position_m: Array, earth: EarthField, irons: tuple[MagneticDipole, ...], path: WalkingPath
) -> Array:
    """Compute the field (n, 3) in uT at positions (n, 3), m, both east, north, up."""
    field = np.tile(earth.vector_ut, (len(position_m), 1))
    for iron in irons:
        field += _dipole_field_ut(position_m - _dipole_position_m(iron, path), np.array(iron.moment_am2), iron.size_m)
    return field


def _dipole_position_m(iron: MagneticDipole, path: WalkingPath) -> Array:
    """Compute the position (3,) of a dipole in the map frame."""
    beside = path.at(np.array([iron.at_m]))
    heading = beside.heading_rad[0]
    east, north = beside.position_m[0] + iron.left_m * np.array([-np.sin(heading), np.cos(heading)])
    return np.array([east, north, iron.up_m])


def _dipole_field_ut(from_it_m: Array, moment_am2: Array, size_m: float) -> Array:
    """Compute the field (n, 3) of a dipole at places (n, 3) relative to it."""
    distance_m = np.maximum(np.linalg.norm(from_it_m, axis=1), size_m)[:, None]
    along = (from_it_m @ moment_am2)[:, None]
    field: Array = _UT_PER_DIPOLE * (3.0 * from_it_m * along / distance_m**5 - moment_am2 / distance_m**3)
    return field
