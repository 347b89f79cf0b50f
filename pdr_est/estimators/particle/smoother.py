"""Estimator `particle`: smoothed tracks of all devices of a walk, on a floor plan if there is one."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.estimators.blas_threads import one_blas_thread
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.particle.backward import DrawnPaths, simulate_backward
from pdr_est.estimators.particle.cloud import START_EAST
from pdr_est.estimators.particle.filtered_walk import ParticleWalk, WalkInput, filter_by_particles, window_of
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.paths.path_summary import middlemost_path, track_of_paths
from pdr_est.estimators.particle.places.modes import place_modes
from pdr_est.estimators.particle.places.open_start import begins_anywhere, search_settings
from pdr_est.estimators.particle.places.start_region import start_region
from pdr_est.estimators.particle.plan.plan_grid import PlanGrid
from pdr_est.estimators.particle.plan.plans_in_time import PlansInTime
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.floor_plan import PresentFloor
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.on_plan.places import PlaceSearch, in_percent
from pdr_est.types.track import Track, concatenate

_MOST_FILTERS = 3  # of a walk that may begin anywhere
_TOLD = 0.25  # probability from which on a finding says that a plan has nothing to do with a walk; ours
_SURE = 9.0  # logarithm of the odds of a plan that fits, as its ways tell, from which on it is not questioned; ours


def estimate(
    timelines: Sequence[Timeline],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    floors: Sequence[PresentFloor],
    parameters: ParticleParams,
) -> Track:
    """Estimate the smoothed tracks of all devices.

    For the probability that the plans have nothing to do with the walk, the track is that without them; where it is
    not small, a finding says so.

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
    on_plan = search_settings(parameters) if begins_anywhere(timelines, start) else parameters
    with one_blas_thread():
        return _smoothed(walk, PlansInTime.of(floors, on_plan, window_of(walk)), floors)


def _smoothed(walk: WalkInput, plans: PlansInTime | None, floors: Sequence[PresentFloor]) -> Track:
    """Filter and smooth a walk, on its plans as far as they have to do with it."""
    filtered = filter_by_particles(walk, plans)
    if plans is None:
        return _tracks(walk, [_drawn_paths(walk, filtered, walk.parameters.paths)], None)
    unrelated = probability_unrelated(filtered, walk)
    if filtered.places and unrelated > 0.5:
        filtered, unrelated = _best_of_several(walk, plans, filtered, unrelated)
    findings = (unrelated_finding(floors, unrelated),) if unrelated > _TOLD else ()
    begun = filtered.blocks[0].plan
    if unrelated <= 0.5 and filtered.places and begun is not None:
        track = _found_on_plan(walk, plans, filtered, begun.grid)
    else:
        track = _mixed(walk, plans, filtered, unrelated)
    return replace(track, findings=(*track.findings, *findings))


def _best_of_several(
    walk: WalkInput, plans: PlansInTime, filtered: ParticleWalk, unrelated: float
) -> tuple[ParticleWalk, float]:
    """Filter a walk that may begin anywhere again, with other random numbers, because its plan does not seem to fit.

    Particles of a whole floor may lose the true place by chance, and then nothing fits. The filter with the most
    evidence for the plan is taken, with the probability that the plan is unrelated.
    """
    for number in range(1, _MOST_FILTERS):
        other = replace(walk.parameters, seed=walk.parameters.seed + number)
        again = filter_by_particles(replace(walk, parameters=other), plans)
        probability = probability_unrelated(again, walk)
        if probability < unrelated:
            filtered, unrelated = again, probability
        if unrelated <= 0.5:
            break
    return filtered, unrelated


def probability_unrelated(filtered: ParticleWalk, walk: WalkInput) -> float:
    """Return the probability that the plans have nothing to do with a walk.

    A walk that has nothing to do with a plan begins anywhere in the rectangle about it, and meets a wall once in
    the mean free path, but is clearly more probable than off the walkable area all the time. Its measurements are as
    probable as without a plan.
    """
    prior = walk.parameters.unrelated_plan
    if prior in (0.0, 1.0):
        return prior
    own = filtered.evidence
    log_odds = float(np.log((1.0 - prior) / prior)) + own.log_ways + own.walls
    if log_odds < _SURE:  # else the filter without a plan is left out, for its time
        least = walk.parameters.least_particles
        free = filter_by_particles(replace(walk, parameters=replace(walk.parameters, most_particles=least)), None)
        log_odds += own.log_measurements - free.evidence.log_measurements
    return float(1.0 / (1.0 + np.exp(np.clip(log_odds, -700.0, 700.0))))


def unrelated_finding(floors: Sequence[PresentFloor], probability: float) -> Finding:
    """Report plans that do not fit."""
    names = list(dict.fromkeys(repr(one.plan.name) for one in floors if one.plan is not None))
    subject, verb = (f"the plan {names[0]}", "does") if len(names) == 1 else (f"the plans {', '.join(names)}", "do")
    return Finding(
        FindingKind.PLAN,
        f"{subject} {verb if probability > 0.5 else 'may'} not fit this walk (probability "
        f"{in_percent(probability)}); with that probability the track is the one without a plan: check the floor, "
        "the scale and the frame of the plan, and the start",
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
    decided = search.unique_since is not None
    track = _tracks(walk, [_drawn_paths(walk, again, walk.parameters.paths)], plans, one_path=not decided)
    return replace(
        track, places=search, findings=track.findings if decided else (*track.findings, place_finding(search))
    )


def _mixed(walk: WalkInput, plans: PlansInTime, filtered: ParticleWalk, unrelated: float) -> Track:
    """Make tracks of paths on the plans, and without them for the probability that they are unrelated."""
    paths = walk.parameters.paths
    free = round(unrelated * paths)
    parts = []
    if free < paths:
        parts.append(_drawn_paths(walk, filtered, paths - free))
    if free:
        parts.append(_drawn_paths(walk, filter_by_particles(walk, None), free))
    return _tracks(walk, parts, plans if 2 * free < paths else None)


def _drawn_paths(walk: WalkInput, filtered: ParticleWalk, paths: int) -> DrawnPaths:
    """Draw paths from the posterior of a filtered walk."""
    rng = np.random.default_rng([walk.parameters.seed, 1])
    closed = [one.closure_sigma_m is not None for one in walk.timelines]
    return simulate_backward(filtered.blocks, closed, paths, rng)


def _tracks(walk: WalkInput, parts: Sequence[DrawnPaths], plans: PlansInTime | None, one_path: bool = False) -> Track:
    """Make the tracks of all devices of the paths of one or several posteriors, or of the middlemost path alone."""
    poses = [np.concatenate(own, axis=2) for own in zip(*(part[0] for part in parts), strict=True)]
    chosen = middlemost_path(np.concatenate(poses)[:, :2]) if one_path else None
    tracks = []
    for device, timeline in enumerate(walk.timelines):
        log_scale = np.concatenate([part[1][device] for part in parts])
        shift_m = np.concatenate([part[2][device] for part in parts], axis=2)
        tracks.append(track_of_paths(timeline, poses[device], log_scale, plans, shift_m, chosen))
    return replace(concatenate(tracks), on_plan=plans is not None)
