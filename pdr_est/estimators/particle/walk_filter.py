"""Particle filter of a walk: nodes, measurements and tethers come in order of time and change the particles."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators.common.initial_state import SIGMA_INITIAL_HEADING_RAD
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.tethers import PairTether
from pdr_est.estimators.particle.cloud import DEVICE_ROWS, HEADING, LOG_SCALE, NORTH, Cloud, effective, systematic
from pdr_est.estimators.particle.kernel import moved_by_kernel, roughened_scale
from pdr_est.estimators.particle.likelihoods import (
    closure_likelihood,
    fix_likelihood,
    heading_likelihood,
    tether_likelihood,
    with_reference,
    with_source,
    with_wandering_error,
)
from pdr_est.estimators.particle.motion import ParticleMotion
from pdr_est.estimators.particle.number import wanted_number
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.places.resampling import shares_by_place
from pdr_est.estimators.particle.plan.displacement import draw_displacements, roughened_displacement, shift_at
from pdr_est.estimators.particle.plan.plan_model import PlanModel
from pdr_est.frames import Array

_RESAMPLED = 0.5  # share of effective particles below which they are resampled
_STARVED = 0.1  # share of effective particles below which a measurement is taken in several parts
_MOST_PARTS = 100  # of a measurement
_TRUST_ANYWHERE = 0.5  # power of the evidence of a way for places: errors of a plan are common to several steps; ours
_STRAYS_TO_A_WALL = 2.0  # stray lengths to a wall of an unrelated plan at least: ways beside the plan cost more; ours
_SIGMA_ENTERING_M = 0.2  # of the place of a late device against that of another: the pace within a step is not known


@dataclass
class WalkEvidence:
    """Evidence of a walk.

    Attributes
    ----------
    log_measurements
        Logarithm of the probability density of all measurements.
    log_ways
        Logarithm of the probability of all ways on the plan, against a start anywhere; 0 without a plan.
    walls
        Number of walls that ways of their length meet where they have nothing to do with the plan.
    """

    log_measurements: float = 0.0
    log_ways: float = 0.0
    walls: float = 0.0


class WalkFilter:
    """Particle filter of all devices of a walk.

    Parameters
    ----------
    cloud
        Particles at the start.
    parameters
        Settings.
    plan
        The plan of the floor at the start, or None without one.
    rng
        Source of random numbers.
    anywhere
        True for a walk that may have begun anywhere on the plan.
    """

    def __init__(
        self,
        cloud: Cloud,
        parameters: ParticleParams,
        plan: PlanModel | None,
        rng: np.random.Generator,
        anywhere: bool = False,
    ) -> None:
        self.plan = plan
        self.evidence = WalkEvidence()
        self._parameters = parameters
        self._rng = rng
        self._anywhere = anywhere
        self.cloud = cloud if plan is None or anywhere else _displaced(cloud, rng)

    def move(self, device: int, node: Node) -> None:
        """Move the particles of a device over the motion that leads to a node, within the walls of the plan."""
        self._resample_if_needed()
        state = self.cloud.state.copy()
        rows = state[DEVICE_ROWS * device : DEVICE_ROWS * (device + 1)]
        if self.plan is None:
            motion = ParticleMotion.to(node)
            motion.move(rows, motion.chosen(rows.shape[1], self._rng), self._rng)
            self.cloud = self.cloud.with_state(state)
            return
        place_m = rows[: NORTH + 1]
        shift_m = shift_at(self.cloud.displacement, place_m, self.plan.anchor_m)
        place_m -= shift_m  # on the plan
        log = self.plan.move(rows, node, self._rng)
        if self.plan.directions is not None:
            log += self.plan.directions.log_weight(rows, node.length_m)
        place_m += shift_m
        self.cloud = self.cloud.with_state(state)
        self._weigh_by_plan(log, _TRUST_ANYWHERE if self._anywhere else 1.0)
        free_m = max(self.plan.free_path_m, _STRAYS_TO_A_WALL * self.plan.stray_length_m)
        self.evidence.walls += node.length_m / free_m / self.cloud.devices

    def begin(self, device: int) -> None:
        """Weigh the particles of a device by whether their start is walkable on the plan."""
        if self.plan is None:
            return
        self._weigh_by_plan(_log_place(self.plan, self.cloud, device))
        self.evidence.log_ways -= float(np.log(self.plan.walkable_share)) / self.cloud.devices

    def _weigh_by_plan(self, log: Array, trust: float = 1.0) -> None:
        """Weigh the particles by the log probabilities (n,) of ways of a device, each device for its share."""
        share = log / self.cloud.devices
        self.evidence.log_ways += log_mean(self.cloud.log_weight, share)
        self.cloud = self.cloud.with_log_weight(self.cloud.log_weight + trust * share)

    def change_floor(self, plan: PlanModel | None, devices: Iterable[int]) -> None:
        """Take the plan of the floor that the walker is on from now on; None between floors.

        Parameters
        ----------
        plan
            The plan. On another one than before, particles are weighed by whether they are on its walkable ground.
        devices
            Numbers of the devices that have begun.
        """
        before, self.plan = self.plan, plan
        if plan is None or (before is not None and before.grid is plan.grid):
            return
        for device in devices:
            log = (_log_place(plan, self.cloud, device) - np.log(plan.walkable_share)) / self.cloud.devices
            known = self.evidence.log_measurements
            ways = self.evidence.log_ways + log_mean(self.cloud.log_weight, log)
            self._weigh(lambda cloud, own=device: _log_place(plan, cloud, own) / cloud.devices)  # type: ignore[misc]
            self.evidence = WalkEvidence(known, ways, self.evidence.walls)

    def measure(self, device: int, node: Node) -> None:
        """Weigh the particles by the fixes and headings of a node."""
        for prior in node.priors:
            self._weigh(lambda cloud, one=prior: heading_likelihood(cloud, device, one))  # type: ignore[misc]
            self.cloud = with_reference(self.cloud, device, prior)
        for fix in node.fixes:
            self.cloud, source = with_source(self.cloud, device, fix)
            self._weigh(lambda cloud, one=fix, own=source: fix_likelihood(cloud, device, one, own))  # type: ignore[misc]
            self.cloud = with_wandering_error(self.cloud, device, fix, source)

    def tether(self, tethers: Sequence[PairTether]) -> None:
        """Weigh the particles by tethers at the present poses."""
        if tethers:
            self._weigh(lambda cloud: tether_likelihood(cloud, tethers))

    def close(self, device: int, sigma_m: float) -> None:
        """Weigh the particles by the distance of the present pose of a device from its start."""
        self._weigh(lambda cloud: closure_likelihood(cloud, device, sigma_m))

    def enter(self, device: int, donor: int) -> None:
        """Put a device that begins late where another one is."""
        state = self.cloud.state.copy()
        rows = state[DEVICE_ROWS * device : DEVICE_ROWS * (device + 1)]
        rows[: HEADING + 1] = self.cloud.device(donor)[: HEADING + 1]
        sigma = np.array([[_SIGMA_ENTERING_M], [_SIGMA_ENTERING_M], [SIGMA_INITIAL_HEADING_RAD]])
        rows[: HEADING + 1] += sigma * self._rng.standard_normal((3, len(self.cloud)))
        self.cloud = self.cloud.with_state(state)

    def add_device(self) -> None:
        """Add a device that was not known when the walk began, with a pose of the first one."""
        cloud, begin = self.cloud, DEVICE_ROWS * self.cloud.devices
        state = np.concatenate([cloud.state[:begin], cloud.state[:DEVICE_ROWS], cloud.state[begin:]])
        self.cloud = replace(cloud, state=state, devices=cloud.devices + 1)

    def _resample_if_needed(self) -> None:
        weights = self.cloud.weights
        share = shares_by_place(self.cloud, weights) if self._anywhere else weights
        if effective(share) >= _RESAMPLED * len(share):
            return
        count = wanted_number(self.cloud, share, self._parameters, self._anywhere)
        kept = systematic(share, count, float(self._rng.random()))
        state = self.cloud.state[:, kept]
        for device in range(self.cloud.devices):
            row = DEVICE_ROWS * device + LOG_SCALE
            state[row] = roughened_scale(state[row], self._rng)
        left = np.log(weights[kept] / share[kept]) if self._anywhere else np.zeros(count)
        self.cloud = replace(self.cloud, state=state, log_weight=left)
        if self.plan is not None and not self._anywhere:
            self.cloud.displacement[:] = roughened_displacement(self.cloud.displacement, self._rng)

    def _weigh(self, likelihood: Callable[[Cloud], Array]) -> None:
        """Multiply the weights by a likelihood, in several parts where few particles would be left.

        After each part the particles are resampled and moved by a kernel, so that they follow the likelihood to where
        there were few of them (progressive correction). Those of a walk that may have begun anywhere are many, and a
        kernel of their covariance would move them from place to place.
        """
        left = 1.0
        for _ in range(0 if self._anywhere else _MOST_PARTS):
            log = likelihood(self.cloud)
            part = _largest_part(self.cloud.log_weight, log, left)
            self.evidence.log_measurements += log_mean(self.cloud.log_weight, part * log)
            self.cloud = self.cloud.with_log_weight(self.cloud.log_weight + part * log)
            left -= part
            if left <= 1e-9:
                return
            self.cloud = moved_by_kernel(self.cloud, self._rng, self.plan)
        log = likelihood(self.cloud)
        self.evidence.log_measurements += log_mean(self.cloud.log_weight, left * log)
        self.cloud = self.cloud.with_log_weight(self.cloud.log_weight + left * log)


def log_mean(log_weight: Array, log: Array) -> float:
    """Return the logarithm of the weighted mean of what has logarithms (n,), by logarithms (n,) of the weights."""
    weights, most = np.exp(log_weight - log_weight.max()), float(log.max())
    return most + float(np.log(weights @ np.exp(log - most) / weights.sum()))


def _log_place(plan: PlanModel, cloud: Cloud, device: int) -> Array:
    """Return the log probabilities (n,) of the places of a device on a plan, as the plan is displaced."""
    place_m = cloud.device(device)[: NORTH + 1]
    return plan.log_place(place_m - shift_at(cloud.displacement, place_m, plan.anchor_m))


def _displaced(cloud: Cloud, rng: np.random.Generator) -> Cloud:
    """Return a cloud whose particles say how the plan is displaced."""
    found = cloud.with_state(cloud.state.copy())
    found.displacement[:] = draw_displacements(len(cloud), rng)
    return found


def _largest_part(log_weight: Array, log: Array, left: float) -> float:
    """Return the largest part of a likelihood, at most `left`, that leaves enough effective particles."""

    def enough(part: float, share: float) -> bool:
        total = log_weight + part * log
        weights = np.exp(total - total.max())
        return effective(weights / weights.sum()) >= share * len(weights)

    if enough(left, _STARVED):
        return left
    low, high = 0.0, left
    for _ in range(12):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if enough(middle, _RESAMPLED * 0.5) else (low, middle)
    return low
