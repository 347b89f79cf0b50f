"""Estimator `particle`: smoothed tracks of all devices of a walk, on a floor plan if there is one."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.particle.backward import simulate_backward
from pdr_est.estimators.particle.cloud import START_EAST
from pdr_est.estimators.particle.filtered_walk import ParticleWalk, WalkInput, filter_by_particles, window_of
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.paths.path_summary import track_of_paths
from pdr_est.estimators.particle.places.modes import place_modes
from pdr_est.estimators.particle.places.start_region import start_region
from pdr_est.estimators.particle.plan.plan_grid import PlanGrid
from pdr_est.estimators.particle.plan.plans_in_time import PlansInTime
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.floor_plan import PresentFloor
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.on_plan.places import PlaceSearch
from pdr_est.types.track import Track, concatenate

_MOST_FILTERS = 3  # of a walk that may begin anywhere


def estimate(
    timelines: Sequence[Timeline],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    floors: Sequence[PresentFloor],
    parameters: ParticleParams,
) -> Track:
    """Estimate the smoothed tracks of all devices.

    Plans that have probably nothing to do with the walk are left out, and a finding says so.

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
    floors
        The floors of the walk with their plans, in order of time; empty without plans.
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
    plans = PlansInTime.of(floors, parameters, window_of(walk))
    filtered = filter_by_particles(walk, plans)
    if plans is None:
        return _smoothed(walk, None, filtered)
    if filtered.places:
        filtered = _best_of_several(walk, plans, filtered)
    unrelated = probability_unrelated(filtered, parameters)
    if unrelated <= 0.5:
        begun = filtered.blocks[0].plan
        if filtered.places and begun is not None:
            return _found_on_plan(walk, plans, filtered, begun.grid)
        return _smoothed(walk, plans, filtered)
    track = _smoothed(walk, None, filter_by_particles(walk, None))
    return replace(track, findings=(*track.findings, unrelated_finding(floors, unrelated)))


def _best_of_several(walk: WalkInput, plans: PlansInTime, filtered: ParticleWalk) -> ParticleWalk:
    """Filter a walk that may begin anywhere once more with other random numbers where its plan does not seem to fit.

    Particles of a whole floor may lose the true place by chance, and then nothing fits. The filter with the most
    evidence for the plan is taken.
    """
    for number in range(1, _MOST_FILTERS):
        if probability_unrelated(filtered, walk.parameters) <= 0.5:
            break
        other = replace(walk.parameters, seed=walk.parameters.seed + number)
        again = filter_by_particles(replace(walk, parameters=other), plans)
        filtered = min((filtered, again), key=lambda one: probability_unrelated(one, walk.parameters))
    return filtered


def probability_unrelated(filtered: ParticleWalk, parameters: ParticleParams) -> float:
    """Return the probability that the plans have nothing to do with a walk.

    A walk that has nothing to do with a plan begins anywhere in the rectangle about it, and meets a wall once in
    the mean free path.
    """
    prior = parameters.unrelated_plan
    if prior in (0.0, 1.0):
        return prior
    log_odds = np.log((1.0 - prior) / prior) + filtered.fit.log_evidence + filtered.fit.walls
    return float(1.0 / (1.0 + np.exp(np.clip(log_odds, -700.0, 700.0))))


def unrelated_finding(floors: Sequence[PresentFloor], probability: float) -> Finding:
    """Report plans that do not fit."""
    names = list(dict.fromkeys(repr(one.plan.name) for one in floors if one.plan is not None))
    subject, it = (
        (f"the plan {names[0]} does", "it") if len(names) == 1 else (f"the plans {', '.join(names)} do", "them")
    )
    return Finding(
        FindingKind.PLAN,
        f"{subject} not fit this walk (probability {probability:.0%}), and the track is made "
        f"without {it}: check the floor, the scale and the frame of the plan, and the start",
        value=probability,
    )


def place_finding(search: PlaceSearch) -> Finding:
    """Report a place on the plan that is not decided."""
    return Finding(FindingKind.PLAN, search.words, value=search.end.modes[0].probability)


def _found_on_plan(walk: WalkInput, plans: PlansInTime, filtered: ParticleWalk, grid: PlanGrid) -> Track:
    """Smooth a walk that may begin anywhere on the plan, with the search for its place.

    Few particles of the whole plan began where the walk did. It is therefore filtered once more, with all of them
    where it can have begun.
    """
    again = filter_by_particles(walk, plans, start_region(grid, filtered.blocks[-1].cloud))
    end = again.blocks[-1].cloud
    begun = replace(filtered.places[0], modes=place_modes(end.device(0)[START_EAST:], end.weights))
    search = PlaceSearch(filtered.places, begun, again.places[-1])
    track = _smoothed(walk, plans, again)
    open_place = () if search.unique_since is not None else (place_finding(search),)
    return replace(track, places=search, findings=(*track.findings, *open_place))


def _smoothed(walk: WalkInput, plans: PlansInTime | None, filtered: ParticleWalk) -> Track:
    """Draw paths from the posterior and make the tracks of them."""
    rng = np.random.default_rng([walk.parameters.seed, 1])
    closed = [one.closure_sigma_m is not None for one in walk.timelines]
    poses, log_scale = simulate_backward(filtered.blocks, closed, walk.parameters.paths, rng)
    track = concatenate(
        [
            track_of_paths(timeline, own, scale, plans)
            for timeline, own, scale in zip(walk.timelines, poses, log_scale, strict=True)
        ]
    )
    return replace(track, on_plan=plans is not None)
