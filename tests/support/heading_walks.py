"""Steps with made-up headings, for what is found in them afterwards."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from heading_steps import SAMPLES, block, step_of
from signals import RATE_HZ

from pdr_est.frames import Array, wrap_angle
from pdr_est.types.steps import CarryingMode, Step

STEP_S = SAMPLES / RATE_HZ


def with_headings(heading_rad: Sequence[float] | Array, segment: int = 0) -> list[Step]:
    """Steps one after the other with these headings, wrapped as stages give them."""
    return [
        replace(step_of(block(number, segment=segment), CarryingMode.HOLDING), heading_rad=float(wrap_angle(angle)))
        for number, angle in enumerate(heading_rad)
    ]


def of_legs(legs: Sequence[tuple[float, int]]) -> Array:
    """Headings, rad, of a walk along straight legs. legs: direction in degrees, not wrapped, and number of steps."""
    return np.concatenate([np.full(count, np.deg2rad(direction)) for direction, count in legs])


def random_legs(rng: np.random.Generator, spacing_deg: float, count: int, least: int = 12, most: int = 30) -> Array:
    """Headings of a walk that turns by the spacing, or by a multiple of it up to 120 degrees, to either side."""
    turns = np.arange(1, int(120.0 // spacing_deg) + 1) * spacing_deg
    direction, legs = 17.0, []
    for _ in range(count):
        legs.append((direction, int(rng.integers(least, most))))
        direction += float(rng.choice([-1.0, 1.0]) * rng.choice(turns))
    return of_legs(legs)


def unsteady(heading_rad: Array, rng: np.random.Generator, per_sqrt_s: float, of_step: float = 0.03) -> Array:
    """Headings (n,) with a random walk and an error of each step."""
    walk = np.cumsum(rng.standard_normal(len(heading_rad))) * per_sqrt_s * np.sqrt(STEP_S)
    return np.asarray(heading_rad + walk + of_step * rng.standard_normal(len(heading_rad)))


def park(rng: np.random.Generator, count: int) -> Array:
    """Headings of a path that bends smoothly all along, to the left and to the right."""
    bend = np.convolve(rng.standard_normal(count + 60), np.hanning(30), mode="valid")[:count]
    return np.asarray(np.cumsum(0.06 * bend / bend.std()))
