"""Standing after a walk tells of the headings in it."""

from dataclasses import replace

import numpy as np
import pytest
from heading_walks import with_headings

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.whole_walk.later_standing import with_later_standing
from pdr_est.types.sensors import Hole
from pdr_est.types.steps import Step


def walk(bias: Array, sigma: Array, up: Array | None = None) -> list[Step]:
    """Straight on by the headings, which drift by what the bias lacks of 1 degree per second."""
    steps = with_headings(np.zeros(len(bias)))
    time_s = np.array([step.event.time_s for step in steps])
    drift = np.cumsum((np.deg2rad(1.0) - bias) * np.diff(time_s, prepend=time_s[0]))
    return [
        replace(
            step,
            heading_rad=float(wrap_angle(angle)),
            samples=replace(
                step.samples,
                turn_bias_radps=np.tile([bias[k], sigma[k]], (len(step.samples), 1)),
                up=step.samples.up if up is None else np.tile(up[k], (len(step.samples), 1)),
            ),
        )
        for k, (step, angle) in enumerate(zip(steps, drift.tolist(), strict=True))
    ]


def known_late(count: int = 100) -> tuple[Array, Array]:
    late = np.arange(count) >= count - 5
    return np.where(late, np.deg2rad(1.0), 0.0), np.deg2rad(np.where(late, 0.02, 0.5))


def test_a_bias_that_is_known_at_the_end_is_taken_off_from_the_beginning() -> None:
    steps = walk(*known_late())
    assert np.rad2deg(abs(steps[-1].heading_rad)) > 20.0
    found = with_later_standing(steps)
    assert np.rad2deg(max(abs(step.heading_rad) for step in found)) < 2.0


def test_it_is_another_one_about_the_vertical_of_a_phone_that_was_turned_over() -> None:
    up = np.where(np.arange(100)[:, None] < 60, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    steps = walk(*known_late(), up)
    found = with_later_standing(steps)
    before = [step.heading_rad for step in found[:60]]
    assert before == pytest.approx([step.heading_rad for step in steps[:60]])
    assert np.rad2deg(abs(found[-1].heading_rad - found[61].heading_rad)) < 2.0


def test_walks_without_standing_and_without_estimates_stay_as_they_are() -> None:
    steps = walk(np.zeros(50), np.full(50, np.deg2rad(0.2)))
    assert with_later_standing(steps) == steps
    unknown = with_headings(np.zeros(50))
    assert with_later_standing(unknown) == unknown


def with_gap(steps: list[Step], gap: Hole, first: int = 50) -> list[Step]:
    """The same steps with a gap of the recording before one of them, over which the headings stay as they were."""
    later_s = gap.end_s - gap.start_s
    return [
        *steps[:first],
        *(
            replace(
                step,
                event=replace(step.event, time_s=step.event.time_s + later_s, segment=1),
                start_s=step.start_s + later_s,
                holes=(gap,) if number == 0 else (),
            )
            for number, step in enumerate(steps[first:])
        ),
    ]


def test_no_bias_turns_the_yaw_over_a_gap_that_is_not_bridged() -> None:
    steps = walk(*known_late())
    end_s = steps[49].event.time_s
    found = with_later_standing(with_gap(steps, Hole(end_s, end_s + 300.0)))
    assert np.rad2deg(max(abs(step.heading_rad) for step in found)) < 5.0  # the bias changes a little in 300 s


def test_after_a_gap_of_unknown_duration_the_bias_is_known_for_the_steps_after_it_only() -> None:
    steps = walk(*known_late())
    end_s = steps[49].event.time_s
    found = with_later_standing(with_gap(steps, Hole(end_s, end_s + 1.0, duration_known=False)))
    assert [step.heading_rad for step in found[:50]] == pytest.approx([step.heading_rad for step in steps[:50]])
    assert np.rad2deg(abs(wrap_angle(found[-1].heading_rad - found[50].heading_rad))) < 2.0
