"""Is a simulated walk turned by a change of placement while its track claims to know better?

    python experiments/turned_walkers.py [--first 70000] [--walks 200]

Each walker walks 5 to 9 corridors and puts the phone elsewhere one to four times, at random times. Of the corners of
three quarters of the walks 80 % have 90 and the others 45 degrees (`mixed`); those of the other walks have any angle
between 20 and 130 degrees. `right` has corners of 90 degrees only, `free` corners of any angle only. The track is
that of the defaults, from the known start.

The heading error of a step is that of the track, the median over nine steps, so that a corner that is taken a step
too early is none. A walk is turned if it exceeds 30 degrees at five steps, and turned unawares if the standard
deviation of the heading is below 15 degrees at five of these.

Writes experiments/results/turned_walkers.json and .txt.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from recorded import command_line, write

from pdr_est.config import Config, StartParams
from pdr_est.frames import Array, wrap_angle
from pdr_est.pipeline import smooth_recording
from pdr_est.simulate import PathParams, Scenario, SensorParams, SimulatedWalk, sample_person, simulate_walk
from pdr_est.simulate.people.carried_device import carried_device
from pdr_est.simulate.walker.step_schedule import mean_speed_mps
from pdr_est.simulate.walker.walking_path import WalkingPath
from pdr_est.types.steps import CarryingMode

Corners = Literal["mixed", "right", "free"]
MODES = (CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET)
LEG_M, FREE_CORNER_DEG = (8.0, 25.0), (20.0, 130.0)
APART_S, FIRST_S, LAST_S = 7.0, 5.0, 6.0  # least times between two changes, before the first and after the last one
TURNED_RAD, SIGMA_RAD, LEAST_STEPS = np.deg2rad(30.0), np.deg2rad(15.0), 5


@dataclass(frozen=True)
class HeadingErrors:
    """Heading errors (steps,) of a track and their standard deviations, rad."""

    error_rad: Array
    sigma_rad: Array

    @property
    def turned(self) -> bool:
        """Return True if the walk is turned."""
        return bool(np.sum(self._beyond()) >= LEAST_STEPS)

    @property
    def unawares(self) -> bool:
        """Return True if the walk is turned while the standard deviation is small."""
        return bool(np.sum(self._beyond() & (self.sigma_rad < SIGMA_RAD)) >= LEAST_STEPS)

    def _beyond(self) -> Array:
        padded = np.pad(np.unwrap(self.error_rad), 4, mode="edge")
        return np.asarray(np.abs(wrap_angle(np.median(sliding_window_view(padded, 9), axis=1))) > TURNED_RAD)


def walker(seed: int, corners: Corners) -> Scenario:
    """Draw a walker, a path and the changes of placement."""
    rng = np.random.default_rng([seed, 77])
    person = sample_person(rng)
    path = PathParams(vertices_m=corridors(rng, corners))
    duration_s = WalkingPath(path).length_m / mean_speed_mps(person.gait)
    starts_s = times_of_changes(rng, duration_s)
    order = [MODES[int(rng.integers(3))]]
    for _ in starts_s:
        order.append([mode for mode in MODES if mode != order[-1]][int(rng.integers(2))])
    device = carried_device(
        person, order, (person.gait.lead_in_s + starts_s).tolist(), rng, SensorParams(rate_hz=50.0)
    )
    seed_of_walk = int(rng.integers(2**31))
    return Scenario(path=path, gait=person.gait, body=person.body, devices=(device,), seed=seed_of_walk)


def corridors(rng: np.random.Generator, corners: Corners) -> tuple[tuple[float, float], ...]:
    """Draw the vertices, m, of a path."""
    legs, irregular = int(rng.integers(4, 9)), rng.random() < 0.25
    heading, point, vertices = 0.0, np.zeros(2), [(0.0, 0.0)]
    for _ in range(legs):
        point = point + rng.uniform(*LEG_M) * np.array([np.cos(heading), np.sin(heading)])
        vertices.append((float(point[0]), float(point[1])))
        sign, slight, any_deg = rng.choice([-1.0, 1.0]), rng.random() < 0.2, rng.uniform(*FREE_CORNER_DEG)
        of_building_deg = 45.0 if slight and corners == "mixed" else 90.0
        free = corners == "free" or (irregular and corners == "mixed")
        heading += np.deg2rad(any_deg if free else of_building_deg) * sign
    return tuple(vertices)


def times_of_changes(rng: np.random.Generator, duration_s: float) -> Array:
    """Draw the times, s, at which the phone is put elsewhere; fewer of them on a walk that is too short."""
    count = int(rng.integers(1, 5))
    while True:
        times_s = np.sort(rng.uniform(FIRST_S, duration_s - LAST_S, count))
        if count == 1 or np.min(np.diff(times_s)) > APART_S:
            return np.asarray(times_s)
        if rng.random() < 0.02:
            count -= 1


def heading_errors(walk: SimulatedWalk) -> HeadingErrors:
    """Smooth a walk from its known start and compare the headings of its steps with the path."""
    start_rad = float(wrap_angle(walk.truth_heading_rad[0]))
    start = StartParams(x_m=0.0, y_m=0.0, heading_rad=start_rad, sigma_heading_rad=0.0)
    smoothed = smooth_recording(walk.recording, replace(Config(), start=start))
    middle_s = np.array([0.5 * (step.start_s + step.event.time_s) for step in smoothed.devices[0].steps])
    error = wrap_angle(smoothed.track.heading_rad[1:] - walk.heading_at(middle_s))
    return HeadingErrors(np.asarray(error), smoothed.track.sigma_heading_rad[1:])


def summary(walks: Sequence[HeadingErrors]) -> dict[str, float]:
    """Compute the numbers of a population."""
    error_deg = np.degrees(np.abs(np.concatenate([walk.error_rad for walk in walks])))
    over_sigma = np.concatenate([walk.error_rad / np.maximum(walk.sigma_rad, 1e-3) for walk in walks])
    return {
        "walks": len(walks),
        "turned": sum(walk.turned for walk in walks),
        "turned_unawares": sum(walk.unawares for walk in walks),
        "heading_median_deg": round(float(np.median(error_deg)), 3),
        "heading_p95_deg": round(float(np.percentile(error_deg, 95)), 3),
        "error_over_sigma": round(float(np.sqrt(np.mean(over_sigma**2))), 3),
    }


def as_text(table: Mapping[str, Mapping[str, float]]) -> str:
    """Format a line for each kind of corners."""
    lines = [f"{'corners':10}{'walks':>7}{'turned':>8}{'unawares':>10}{'median':>8}{'95 %':>8}{'/ sigma':>9}"]
    for kind, row in table.items():
        walks, turned, unawares, *rest = row.values()
        lines.append(f"{kind:10}{walks:7}{turned:8}{unawares:10}{rest[0]:8.2f}{rest[1]:8.2f}{rest[2]:9.2f}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    options = command_line(__doc__, {"--first": 70000, "--walks": 200})
    seeds = range(options.first, options.first + options.walks)
    rows = {
        kind: summary([heading_errors(simulate_walk(walker(seed, kind))) for seed in seeds])
        for kind in get_args(Corners)
    }
    write("turned_walkers", as_text(rows), {"first_seed": options.first, "corners": rows})
