"""The dominant directions of a building, estimated from the walk itself.

In a building the straight stretches of a walk lead along a few directions at equal angles: four in most, any number
in others, none in a park. The heading of a stretch, modulo the spacing of the directions, then is the same all over
the walk but for the drift of the heading. Here that drift is a random walk on a circle of the spacing, whose steps
are larger across turns, and it is followed forwards and backwards over the pieces of the straight stretches.

The evidence for a building comes from turns alone: with dominant directions the heading after a turn is foreseen up
to the drift, without them it is anywhere. How the heading moves along a stretch says nothing, for both explain it as
drift; so a winding path is not taken for a bad gyroscope. A stretch as a whole may be a diagonal, which tells nothing
of the drift. Numbers of directions and levels of drift are compared by
their probability. Ours, after the idea of heuristic drift elimination (Borenstein and Ojeda 2010), whose feedback
needs the directions beforehand.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.whole_walk.circular_grid import CircularGrid
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections, StraightLegParams
from pdr_est.params import params
from pdr_est.types.analysis import DominantDirections

# Number of directions, and how probable it is before the walk; what is missing to 1 is that there are none.
_NUMBERS: Mapping[int, float] = MappingProxyType({2: 0.1, 3: 0.04, 4: 0.5, 5: 0.02, 6: 0.04, 8: 0.1})
_NONE = 1.0 - sum(_NUMBERS.values())


@dataclass(frozen=True)
class DriftLevel:
    """How well headings are kept: rad per root second along the way, rad in a quarter turn, rad of a piece about its
    direction, and how probable such a phone is beforehand."""

    per_sqrt_s: float
    per_turn: float
    of_piece: float
    probability: float


# From a phone in a steady hand to one that slips about in a pocket.
_LEVELS = (
    DriftLevel(0.003, 0.045, 0.055, 0.25),
    DriftLevel(0.005, 0.07, 0.06, 0.3),
    DriftLevel(0.012, 0.14, 0.08, 0.25),
    DriftLevel(0.026, 0.2, 0.1, 0.15),
    DriftLevel(0.052, 0.26, 0.12, 0.05),
)
_STRAY = 0.1  # share of pieces that are off their direction: what is left of a corner, detours
_DIAGONAL = 0.02  # share of stretches that follow no dominant direction; this one, too, is ours
_BEGIN = np.array([1.0 - _DIAGONAL, _DIAGONAL])
_BEGIN.flags.writeable = False
_QUARTER_RAD = 0.5 * np.pi
_MOST_TURN = 2.0  # quarter turns, beyond which a turn is not less certain


@params
class DominantParams:
    """enabled: whether they are looked for. number: of directions at equal angles, to be taken as given; null
    estimates it, and whether there are any. direction_rad: one of them in the map, null where unknown; then they hold
    from the first step on, and without a number there are four. least_log_odds: of dominant directions against none,
    from which on they are used. turn_rad: changes of heading between stretches below it are no evidence."""

    enabled: bool = True
    number: Annotated[int, Ge(1), Le(16)] | None = None
    direction_rad: Annotated[float, Ge(-6.3), Le(6.3)] | None = None
    least_log_odds: float = 2.0
    turn_rad: Annotated[float, Ge(0.1), Le(1.5)] = 0.44
    straight: StraightLegParams = StraightLegParams()

    @property
    def given_number(self) -> int | None:
        """The number of directions that is to be taken as given."""
        return 4 if self.number is None and self.direction_rad is not None else self.number


def dominant_directions(pieces: LegSections, parameters: DominantParams) -> DominantDirections | None:
    """The most probable dominant directions of a walk; None for one without straight stretches."""
    if not len(pieces):
        return None
    given = parameters.given_number
    numbers = _NUMBERS if given is None else {given: 1.0 - _NONE}
    turned = _Turned.of(pieces, parameters.turn_rad)
    tried = {number: [_follow(pieces, turned, number, level) for level in _LEVELS] for number in numbers}
    log_odds = {
        number: _log_mean([run.log_with for run in runs])
        - _log_mean([run.log_without for run in runs])
        + np.log(numbers[number] / _NONE)
        for number, runs in tried.items()
    }
    number = max(log_odds, key=lambda one: log_odds[one])
    best = max(
        zip(tried[number], _LEVELS, strict=True), key=lambda pair: pair[0].log_with + np.log(pair[1].probability)
    )
    used = given is not None or log_odds[number] >= parameters.least_log_odds
    return _smoothed(pieces, best[0], number, float(log_odds[number]), bool(used))


@dataclass(frozen=True)
class _Turned:
    """Between each piece but the first and the one before: elapsed_s, quarters of a turn in between, 0 within a
    stretch, elsewhere whether another stretch begins, and tells whether the turn is one that tells something."""

    elapsed_s: Array
    quarters: Array
    elsewhere: NDArray[np.bool_]
    tells: NDArray[np.bool_]

    @classmethod
    def of(cls, pieces: LegSections, turn_rad: float) -> "_Turned":
        change = np.abs(np.diff(pieces.heading_rad))
        elsewhere = np.diff(pieces.stretch) != 0
        quarters = np.where(elsewhere, np.minimum(change / _QUARTER_RAD, _MOST_TURN), 0.0)
        elapsed_s = np.maximum(np.diff(pieces.time_s), 0.1)
        return cls(elapsed_s, quarters, elsewhere, elsewhere & (change > turn_rad))


@dataclass(frozen=True)
class _Run:
    """One number of directions and one level of drift, followed forwards. likelihood, forward: (n, 2, cells) of each
    piece and drift, if its stretch follows a direction and if it is a diagonal. sigma: (n - 1,) of the drift between
    pieces; elsewhere: (n - 1,) whether another stretch begins. log_with, log_without: log probability of the headings
    with dominant directions, and if each turn leads anywhere."""

    circle: CircularGrid
    level: DriftLevel
    likelihood: Array
    forward: Array
    sigma: Array
    elsewhere: NDArray[np.bool_]
    log_with: float
    log_without: float


def _follow(pieces: LegSections, turned: _Turned, number: int, level: DriftLevel) -> _Run:
    circle = CircularGrid(2.0 * np.pi / number)
    along = circle.likelihood(pieces.heading_rad, level.of_piece, _STRAY)
    walked = level.per_sqrt_s**2 * turned.elapsed_s + (level.per_turn * turned.quarters) ** 2
    sigma = np.sqrt(walked + pieces.changed_rad[1:] ** 2)
    diagonal = _foreseen(circle, along, sigma, turned.elsewhere)
    likelihood = np.stack([along, np.broadcast_to(diagonal[:, None], along.shape)], axis=1)
    bound = _BEGIN[:, None] * circle.uniform()
    log_with = 0.0
    forward = np.empty_like(likelihood)
    for i, seen in enumerate(likelihood):
        if i:
            bound = circle.spread(bound, sigma[i - 1])
            if turned.elsewhere[i - 1]:
                bound = _BEGIN[:, None] * bound.sum(axis=0)
        bound = bound * seen
        with_them = float(bound.sum(axis=0).mean())
        log_with += np.log(with_them)
        forward[i] = bound = bound / with_them
    log_without = float(np.log(_foreseen(circle, along, sigma, turned.tells)).sum())
    return _Run(circle, level, likelihood, forward, sigma, turned.elsewhere, log_with, log_without)


def _foreseen(circle: CircularGrid, along: Array, sigma: Array, anew: NDArray[np.bool_]) -> Array:
    """Probabilities (n,) of the pieces by those before, over the uniform one, if some of them, but the first, lead
    anywhere anew (n - 1,)."""
    probability = np.empty(len(along))
    belief = circle.uniform()
    for i, seen in enumerate(along):
        if i:
            belief = circle.uniform() if anew[i - 1] else circle.spread(belief, sigma[i - 1])
        belief = belief * seen
        probability[i] = belief.mean()
        belief = belief / probability[i]
    return probability


def _log_mean(logs: Sequence[float]) -> float:
    """Log of the mean probability over the levels of drift."""
    weights = np.log([level.probability for level in _LEVELS])
    return float(np.logaddexp.reduce(np.array(logs) + weights))


def _smoothed(pieces: LegSections, run: _Run, number: int, log_odds: float, used: bool) -> DominantDirections:
    """Directions of the pieces by what came before and after them."""
    belief, future = np.empty_like(run.forward), np.ones_like(run.forward[0])
    for i in range(len(pieces) - 1, -1, -1):
        belief[i] = run.forward[i] * future
        if i:
            future = future * run.likelihood[i]
            if run.elsewhere[i - 1]:
                future = np.broadcast_to(_BEGIN @ future, future.shape)
            future = run.circle.spread(future, run.sigma[i - 1])
            future = future / future.mean()
    mean, sigma = run.circle.mean(belief.sum(axis=1))
    straight = belief[:, 0].sum(axis=1) / belief.sum(axis=(1, 2))
    spacing = run.circle.spacing_rad
    drift = np.unwrap(mean, period=spacing)
    along = spacing * np.round((pieces.heading_rad - drift) / spacing)
    off = (pieces.heading_rad - drift - along) / run.level.of_piece
    bell = (1.0 - _STRAY) * np.exp(-0.5 * off**2) * spacing / (run.level.of_piece * np.sqrt(2.0 * np.pi))
    return DominantDirections(
        number=number,
        log_odds=log_odds,
        used=used,
        spacing_rad=spacing,
        drift_per_sqrt_s=run.level.per_sqrt_s,
        drift_rad=drift - drift[0],
        sigma_rad=sigma,
        path_heading_rad=along + drift[0],
        follows=straight * bell / (bell + _STRAY),
    )
