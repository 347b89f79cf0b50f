"""Give steps of sideways and backward walking the direction in which the walker moves.

In each place of the phone, the mean leading acceleration of all steps shows the direction of a walker who moves
ahead. A stretch in which the walker does not is searched where the acceleration kept its direction in space for some
steps although the phone turned. Mean and noise of the acceleration, and how often a walker moves sideways, are those
of the walk itself: mean and noise are estimated with the angles in turns, for each of three rates, whose
probabilities follow from the walk.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.course.course_likelihood import (
    LEAST_STEPS,
    LEAST_TURN_RAD,
    LEAST_VARIANCE,
    RATES,
    TURNS_WITHIN,
    AheadMoments,
    angle_and_doubt,
    course_log_likelihood,
    robust_moments,
)
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.leading_acceleration import leading_acceleration, shows_course
from pdr_est.front_end.heading.course.running import MOSTLY, pace_of, runner_density, running_probabilities
from pdr_est.front_end.heading.course.sideways_chain import ANGLES, ANGLES_RAD, sideways_chain
from pdr_est.front_end.heading.phone_posture import wrapped
from pdr_est.front_end.heading.step_motion import motions_of
from pdr_est.front_end.heading.stride_pairing import stride_averages
from pdr_est.records import changed
from pdr_est.types.steps import Step

_ROUNDS = 2  # of estimating mean and noise, and the angles
_WITHIN = 24  # steps since that turn over which the acceleration is compared
_MARGIN_BEFORE, _MARGIN_AFTER = 6, 150  # steps around it that are searched
_LEAST_RAD = 1e-3  # angle and doubt together, below which the walker moves ahead


@dataclass(frozen=True)
class _Run:
    """Steps with the phone in one place: accelerations (n,) turned back by the headings, and which of them count.

    `running` (n,) is the probability that the step is one of a runner. `ahead` (n,) are the steps that tell the
    acceleration of a walker who moves ahead. The last place of the walk is the only one at whose end the walker need
    not move ahead.
    """

    acceleration: NDArray[np.complex128]
    running: Array
    heading_rad: Array
    counts: NDArray[np.bool_]
    ahead: NDArray[np.bool_]
    is_last: bool

    @cached_property
    def runs(self) -> Array:
        """Probability (n,) that the step is one of a runner, times the density of the acceleration of a runner."""
        return self.running * runner_density(self.acceleration)


def moves_ahead(steps: Sequence[Step]) -> NDArray[np.bool_]:
    """Tell at which steps (n,) the walker moved ahead as far as was known online."""
    return np.array([not step.course_offset_rad for step in steps], dtype=bool)


def with_courses(
    steps: Sequence[Step], parameters: CourseParams, ahead: NDArray[np.bool_] | None = None
) -> list[Step]:
    """Turn the headings of steps on which the walker moved sideways or backwards.

    Parameters
    ----------
    steps : sequence of Step
        All steps of a walk, with headings that follow the phone.
    parameters : CourseParams
        Parameters.
    ahead : ndarray of bool, shape (n,), optional
        Steps that tell the acceleration of a walker who moves ahead; by default all.

    Returns
    -------
    list of Step
        The steps; those in such a stretch with the direction of motion as `heading_rad`, and with
        `course_offset_rad` and `sigma_course_rad`.
    """
    done = list(steps)
    if not parameters.enabled or len(steps) < LEAST_STEPS:
        return done
    heading = np.unwrap([step.heading_rad for step in steps])
    acceleration = leading_acceleration(steps) * np.exp(-1j * heading)
    paces = [pace_of(*one) for one in zip(steps, motions_of(steps), strict=True)]
    counts = np.array([shows_course(step) for step in steps])
    if ahead is None:
        ahead = np.ones(len(steps), dtype=bool)
    for first, last in _places(steps):
        part = slice(first, last)
        running = running_probabilities(paces[part], parameters.correlated_steps)
        averages = stride_averages(acceleration[part]), stride_averages(running)
        run = _Run(*averages, heading[part], counts[part], ahead[part], last == len(steps))
        mean_rad, sigma_rad = _offsets(run, parameters)
        for k in np.flatnonzero(np.hypot(mean_rad, sigma_rad) > _LEAST_RAD).tolist():
            done[first + k] = changed(
                steps[first + k],
                heading_rad=wrapped(steps[first + k].heading_rad + float(mean_rad[k])),
                course_offset_rad=float(mean_rad[k]),
                sigma_course_rad=float(sigma_rad[k]),
            )
    return done


def without_courses(steps: Sequence[Step]) -> list[Step]:
    """Return steps whose headings follow the phone again, without what was told of sideways walking online."""
    return [
        changed(
            step,
            heading_rad=wrapped(step.heading_rad - step.course_offset_rad),
            course_offset_rad=0.0,
            sigma_course_rad=0.0,
        )
        if step.course_offset_rad or step.sigma_course_rad
        else step
        for step in steps
    ]


def _places(steps: Sequence[Step]) -> list[tuple[int, int]]:
    """Divide steps, from and to (exclusive), where the phone was put elsewhere or the recording has a gap."""
    begins = [
        k
        for k, step in enumerate(steps)
        if k == 0 or step.turn_hypotheses or step.event.segment != steps[k - 1].event.segment
    ]
    return list(zip(begins, [*begins[1:], len(steps)], strict=True))


def _offsets(run: _Run, parameters: CourseParams) -> tuple[Array, Array]:
    """Compute mean and standard deviation, rad, of the angle between motion and body at each step (n,)."""
    count = len(run.heading_rad)
    nothing = np.zeros(count), np.zeros(count)
    tells = run.counts & run.ahead & (run.running < MOSTLY)
    if np.count_nonzero(tells) < LEAST_STEPS:
        return nothing
    moments = robust_moments(run.acceleration[tells])
    if abs(moments.mean[0]) < parameters.least_clearness * np.sqrt(moments.variance[0]):
        return nothing
    regions = _regions(run, moments, parameters)
    return _search(run, moments, regions, parameters) if regions else nothing


def _regions(run: _Run, moments: AheadMoments, parameters: CourseParams) -> list[tuple[int, int]]:
    """Find the runs of steps, from and to (exclusive), around turns that the phone may have made alone."""
    count = len(run.heading_rad)
    mean, variance = moments.mean[0], moments.variance[0]
    soon = run.heading_rad[np.minimum(np.arange(count)[:, None] + np.arange(1, TURNS_WITHIN + 1), count - 1)]
    turning = np.flatnonzero(np.abs(soon - run.heading_rad[:, None]).max(axis=1) > LEAST_TURN_RAD)
    index = turning[:, None] + np.arange(1, _WITHIN + 1)
    counted = run.counts[np.minimum(index, count - 1)] & (index < count)
    index = np.minimum(index, count - 1)
    straight_on = mean * np.exp(1j * (run.heading_rad[turning, None] - run.heading_rad[index]))
    walks, runs = 1.0 - run.running, run.runs
    ahead = course_log_likelihood(np.abs(run.acceleration - mean) ** 2, variance, parameters, walks, runs)
    distance2 = np.abs(run.acceleration[index] - straight_on) ** 2
    aside = course_log_likelihood(distance2, variance, parameters, walks[index], runs[index])
    gain = np.cumsum(np.where(counted, aside - ahead[index], 0.0), axis=1).max(axis=1)
    searched = np.zeros(count + 1, dtype=np.int64)
    for k in turning[gain >= parameters.least_log_likelihood_ratio].tolist():
        searched[max(k - _MARGIN_BEFORE, 0) : min(k + _WITHIN + _MARGIN_AFTER, count)] = 1
    borders = np.flatnonzero(np.diff(searched, prepend=0)).tolist()
    return list(zip(borders[::2], borders[1::2], strict=True))


def _search(
    run: _Run, moments: AheadMoments, regions: Sequence[tuple[int, int]], parameters: CourseParams
) -> tuple[Array, Array]:
    """Compute mean and standard deviation of the angle from the regions of the run that are searched."""
    count = len(run.heading_rad)
    turn_rad = np.diff(run.heading_rad, prepend=run.heading_rad[0])
    probability = np.zeros((count, len(RATES), ANGLES))
    probability[:, :, 0] = 1.0
    log_evidence = np.zeros(len(RATES))
    walks, runs = 1.0 - run.running[:, None], run.runs[:, None]
    for number in range(_ROUNDS):
        moments = _moments(run, probability) if number else moments
        mean, variance = moments.mean, moments.variance
        distance2 = np.abs(run.acceleration[:, None] - mean) ** 2
        ahead = course_log_likelihood(distance2, variance, parameters, walks, runs)
        log_evidence = np.where(run.counts[:, None], ahead, 0.0).sum(axis=0) + count * np.log1p(-RATES)
        for first, last in regions:
            expected = mean[:, None] * np.exp(1j * ANGLES_RAD)
            distance2 = np.abs(run.acceleration[first:last, None, None] - expected) ** 2
            at_angles = course_log_likelihood(
                distance2, variance[:, None], parameters, walks[first:last, :, None], runs[first:last, :, None]
            )
            over_ahead = at_angles - ahead[first:last, :, None]
            likelihood = np.exp(np.where(run.counts[first:last, None, None], over_ahead, 0.0))
            returns = last < count or not run.is_last
            found = sideways_chain(likelihood, turn_rad[first:last], RATES, returns)
            probability[first:last] = found.probability
            log_evidence += found.log_evidence - (last - first) * np.log1p(-RATES)
    return angle_and_doubt(probability, log_evidence)


def _moments(run: _Run, probability: Array) -> AheadMoments:
    """Compute mean and variance for each rate from the angles that it gives, with the probabilities (n, r, 72)."""
    seen = run.acceleration[run.counts]
    turned_back = seen[:, None] * (probability[run.counts] @ np.exp(-1j * ANGLES_RAD))
    share = 1.0 - run.running[run.counts]
    share /= share.sum()
    mean = share @ turned_back
    total = share @ np.abs(seen) ** 2 - np.abs(mean) ** 2
    return AheadMoments(mean, np.maximum(0.5 * total, LEAST_VARIANCE))
