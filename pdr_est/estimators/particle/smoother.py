"""Estimator `particle`: smoothed tracks of all devices of a walk, on a floor plan if there is one."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.particle.backward import simulate_backward
from pdr_est.estimators.particle.filtered_walk import ParticleWalk, WalkInput, filter_by_particles, window_of
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.path_summary import track_of_paths
from pdr_est.estimators.particle.plan.plan_model import PlanModel
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, StartPose
from pdr_est.types.track import Track, concatenate


def estimate(
    timelines: Sequence[Timeline],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    plan: FloorPlan | None,
    parameters: ParticleParams,
) -> Track:
    """Estimate the smoothed tracks of all devices.

    A plan that has probably nothing to do with the walk is left out, and a finding says so.

    Parameters
    ----------
    timelines
        Measurements of each device.
    tethers
        Tethers between the devices.
    start
        Start pose of the walk as far as it is known.
    sigma_length_scale
        Standard deviation of the walker's length scale around 1.
    plan
        Plan of the floor, or None.
    parameters
        Settings.

    Raises
    ------
    EstimationError
        For a tether to a device without timeline, and for a plan that cannot be drawn.
    """
    walk = WalkInput(
        tuple(timelines), tuple(node_tethers_between(timelines, tethers)), start, sigma_length_scale, parameters
    )
    if plan is None:
        return _smoothed(walk, None, filter_by_particles(walk, None))
    model = PlanModel.of(plan, parameters, window_of(walk))
    filtered = filter_by_particles(walk, model)
    unrelated = probability_unrelated(filtered, model, parameters)
    if unrelated <= 0.5:
        return _smoothed(walk, model, filtered)
    track = _smoothed(walk, None, filter_by_particles(walk, None))
    return replace(track, findings=(*track.findings, unrelated_finding(plan, unrelated)))


def plan_of(devices: Sequence[DeviceMeasurements]) -> FloorPlan | None:
    """Return the floor plan among the measurements of all devices, or None.

    Raises EstimationError for more than one.
    """
    plans = {id(m): m for one in devices for m in one.measurements if isinstance(m, FloorPlan)}
    if len(plans) > 1:
        names = ", ".join(repr(plan.name) for plan in plans.values())
        raise EstimationError(f"{len(plans)} floor plans ({names}): give the one of the floor of the walk")
    return next(iter(plans.values()), None)


def probability_unrelated(filtered: ParticleWalk, model: PlanModel, parameters: ParticleParams) -> float:
    """Return the probability that a plan has nothing to do with a walk.

    A walk that has nothing to do with the plan begins anywhere in the rectangle about it, and meets a wall once in
    the mean free path.
    """
    prior = parameters.unrelated_plan
    if prior in (0.0, 1.0):
        return prior
    log_odds = np.log((1.0 - prior) / prior) + filtered.fit.log_evidence + filtered.fit.length_m / model.free_path_m
    return float(1.0 / (1.0 + np.exp(np.clip(log_odds, -700.0, 700.0))))


def unrelated_finding(plan: FloorPlan, probability: float) -> Finding:
    """Report a plan that does not fit."""
    return Finding(
        FindingKind.PLAN,
        f"the plan {plan.name!r} does not fit this walk (probability {probability:.0%}), and the track is made "
        "without it: check the floor, the scale and the frame of the plan, and the start",
        value=probability,
    )


def _smoothed(walk: WalkInput, model: PlanModel | None, filtered: ParticleWalk) -> Track:
    """Draw paths from the posterior and make the tracks of them."""
    rng = np.random.default_rng([walk.parameters.seed, 1])
    closed = [one.closure_sigma_m is not None for one in walk.timelines]
    poses, log_scale = simulate_backward(filtered.blocks, closed, walk.parameters.paths, model, rng)
    grid = None if model is None else model.grid
    return concatenate(
        [
            track_of_paths(timeline, own, scale, grid)
            for timeline, own, scale in zip(walk.timelines, poses, log_scale, strict=True)
        ]
    )
