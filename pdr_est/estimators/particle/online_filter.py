"""Particle filter that is fed while the devices record: filtered poses of a walk that goes on."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.estimators.common.initial_state import StartPrior, device_starts, start_prior_from
from pdr_est.estimators.common.nodes import SAME_S, Node, NodeBuilder, sort_fixes
from pdr_est.estimators.particle.cloud import DEVICE_ROWS, HEADING, Cloud
from pdr_est.estimators.particle.initial_cloud import (
    initial_cloud,
    placed_at_fix,
    spread_over_plan,
    turned_to_heading,
)
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.places.open_start import search_settings
from pdr_est.estimators.particle.plan.plan_model import PlanModel
from pdr_est.estimators.particle.plan.plans_in_time import PlanModels
from pdr_est.estimators.particle.walk_filter import WalkFilter
from pdr_est.estimators.spec import OnlinePose
from pdr_est.frames import wrap_angle
from pdr_est.types.floor_plan import FloorPlan, PresentFloor
from pdr_est.types.measurements import LATE_START_S, HeadingPrior, LoopClosure, PositionFix, StartPose, StepOdometry


class ParticleOnlineFilter:
    """Online filter of the estimator `particle`; it fits `pdr_est.estimators.spec.OnlineFilter`.

    A floor plan is pushed before everything else; of several floors, the present one is pushed whenever it changes,
    and all of them at the beginning, so that their plans are ready, that of the start last. What the start pose does
    not tell stays open until the first measurement that tells it: a fix places the walk, a heading in the map turns
    it. On a plan the particles begin in every direction, and where the position is not given either, anywhere.

    Parameters
    ----------
    devices
        Names of the devices that are known; others join when their first step comes.
    start
        Start pose, as far as it is known.
    sigma_length_scale
        Standard deviation of the length scale of the walker.
    parameters
        Settings.
    """

    def __init__(
        self, devices: Sequence[str], start: StartPose, sigma_length_scale: float, parameters: ParticleParams
    ) -> None:
        self._names = list(devices)
        self._start, self._sigma_scale, self._parameters = start, sigma_length_scale, parameters
        self._rng = np.random.default_rng(parameters.seed)
        self._plan: PlanModel | None = None
        self._models = PlanModels(search_settings(parameters) if start.position_m is None else parameters)
        self._filter: WalkFilter | None = None
        self._builders: dict[str, NodeBuilder] = {}
        self._fixes: list[PositionFix] = []
        self._waiting: dict[str, list[PositionFix]] = {}
        self._position_open = self._heading_open = False
        self._begun_s = 0.0

    def push(
        self, measurement: StepOdometry | HeadingPrior | PositionFix | LoopClosure | FloorPlan | PresentFloor
    ) -> list[OnlinePose]:
        """Take one measurement, in order of time; return the poses that are new or have changed."""
        if isinstance(measurement, FloorPlan):
            return self._take_floor(PresentFloor(float("-inf"), measurement))
        if isinstance(measurement, PresentFloor):
            return self._take_floor(measurement)
        if isinstance(measurement, StepOdometry):
            return self._take_step(measurement)
        if isinstance(measurement, HeadingPrior):
            return self._take_heading(measurement)
        if isinstance(measurement, PositionFix):
            return self._take_fix(measurement)
        if measurement.device not in self._builders or self._position_open or self._heading_open:
            return []
        self._own.close(self._names.index(measurement.device), measurement.sigma_m)
        return [self._pose(measurement.device)]

    def flush(self) -> list[OnlinePose]:
        """Take the fixes that waited for a further step; called once, at the end of the walk."""
        poses = []
        for device, fixes in self._waiting.items():
            if fixes and device in self._builders:
                self._measure(device, fixes, ())
                poses.append(self._pose(device))
        self._waiting = {}
        return poses

    @property
    def _own(self) -> WalkFilter:
        """Filter of the devices, made when the first of them begins to walk."""
        if self._filter is None:
            anywhere = self._plan is not None and self._start.position_m is None
            self._filter = WalkFilter(self._first_cloud(), self._parameters, self._plan, self._rng, anywhere)
        return self._filter

    def _first_cloud(self) -> Cloud:
        """Draw the particles at the start, before any measurement."""
        start, plan = self._start, self._plan
        self._position_open = start.position_m is None and plan is None
        self._heading_open = start.heading_rad is None and plan is None
        priors = []
        for own in device_starts(max(len(self._names), 1), plan is not None, start):
            known = start_prior_from(None, plan is not None, own, self._sigma_scale)
            priors.append(StartPrior(known.state, False, known.heading_open))
        count = self._parameters.most_particles
        if plan is None:
            return initial_cloud(priors, [()] * len(priors), count, self._rng)
        if start.position_m is not None:
            return initial_cloud(priors, [()] * len(priors), 2 * count, self._rng)
        cloud = initial_cloud(priors, [()] * len(priors), plan.particles_anywhere(self._parameters), self._rng)
        return spread_over_plan(cloud, plan.grid, self._rng)

    def _take_floor(self, present: PresentFloor) -> list[OnlinePose]:
        """Take the plan of the floor that the walker is on from now on."""
        self._plan = self._models.of(present)
        if self._filter is not None:
            self._filter.change_floor(self._plan, [self._names.index(name) for name in self._builders])
        return []

    def _take_step(self, step: StepOdometry) -> list[OnlinePose]:
        """Move a device by a step, with the fixes before it and inside it."""
        found = [] if step.device in self._builders else self._begin(step)
        builder, device = self._builders[step.device], self._names.index(step.device)
        builder.append(step)
        begin_s = builder.motion_begin_s(builder.count)
        waiting = self._waiting.get(step.device, [])
        standing = [fix for fix in waiting if fix.time_s <= begin_s]
        if standing:
            self._measure(step.device, standing, ())
            found.append(self._pose(step.device))
        moving = sort_fixes(fix for fix in waiting if begin_s < fix.time_s < step.time_s)
        self._waiting[step.device] = [fix for fix in waiting if fix.time_s >= step.time_s]
        for node in builder.nodes_of(builder.count, moving):
            self._own.move(device, node)
            self._measure(step.device, node.fixes, ())
        builder.forget(builder.count)
        return [*found, self._pose(step.device)]

    def _begin(self, step: StepOdometry) -> list[OnlinePose]:
        """Let a device begin with its first step; one that comes late begins where another one is."""
        if not self._builders:
            self._begun_s = step.start_s
        if step.device not in self._names:
            self._names.append(step.device)
            own = self._own  # of the devices so far, or with this one
            if own.cloud.devices < len(self._names):
                own.add_device()
        device, late = self._names.index(step.device), step.start_s > self._begun_s + LATE_START_S
        if self._builders and late:
            self._own.enter(device, self._names.index(next(iter(self._builders))))
        self._own.begin(device)
        self._builders[step.device] = NodeBuilder(step.start_s)
        return [replace(self._pose(step.device), time_s=step.start_s)]

    def _take_heading(self, prior: HeadingPrior) -> list[OnlinePose]:
        if prior.device not in self._builders:
            return []
        self._measure(prior.device, (), (prior,))
        return [self._pose(prior.device)]

    def _take_fix(self, fix: PositionFix) -> list[OnlinePose]:
        """Give a fix to every device; it waits where the next step is under way."""
        share = replace(fix, covariance_m2=np.asarray(fix.covariance_m2) * max(len(self._names), 1))
        poses = []
        for name in self._names:
            builder = self._builders.get(name)
            if builder is not None and fix.time_s <= builder.step_end_s(builder.count) + SAME_S:
                self._measure(name, (share,), ())
                poses.append(self._pose(name))
            else:
                self._waiting.setdefault(name, []).append(share)
        return poses

    def _measure(self, name: str, fixes: Sequence[PositionFix], priors: Sequence[HeadingPrior]) -> None:
        """Weigh the particles by measurements at the present pose; the first that tells what is open decides it."""
        own, device = self._own, self._names.index(name)
        for prior in priors:
            if self._heading_open and not prior.relative:
                own.cloud = turned_to_heading(own.cloud, device, prior, self._rng)
                self._heading_open = False
            else:
                own.measure(device, _standing((), (prior,)))
        for fix in fixes:
            if self._position_open or self._heading_open:
                own.cloud = placed_at_fix(own.cloud, device, fix, self._position_open, self._heading_open, self._rng)
                placed, self._position_open, self._heading_open = self._position_open, False, False
                if placed:
                    continue
            own.measure(device, _standing((fix,), ()))

    def _pose(self, name: str) -> OnlinePose:
        """Return mean and covariance of the particles of a device."""
        device, builder = self._names.index(name), self._builders.get(name)
        cloud = self._own.cloud
        rows, weights = cloud.state[DEVICE_ROWS * device : DEVICE_ROWS * device + HEADING + 1], cloud.weights
        heading_rad = float(np.angle(weights @ np.exp(1j * rows[HEADING])))
        mean = np.array([*(rows[:HEADING] @ weights), heading_rad])
        off = rows - mean[:, None]
        off[HEADING] = wrap_angle(off[HEADING])
        time_s = 0.0 if builder is None else builder.step_end_s(builder.count)
        return OnlinePose(name, time_s, mean[:HEADING], heading_rad, (weights * off) @ off.T)


def _standing(fixes: tuple[PositionFix, ...], priors: tuple[HeadingPrior, ...]) -> Node:
    """Return a node without motion, for measurements at the present pose."""
    node = NodeBuilder(0.0).nodes_of(0)[0]
    return replace(node, fixes=fixes, priors=priors)
