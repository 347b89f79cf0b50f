"""Does a plan find the place of a walk whose start nobody knows, and is the place right?

    python experiments/unknown_start.py --data DIR [--shortest 30] [--seeds 1] [--stride 1]

The walks of ILC20 that are at least SHORTEST metres long, on the plans of their floors, with the phone's north and no
start. A place that is told is right if the true position is within 10 m or two standard deviations of it.

Writes experiments/results/unknown_start.json and .txt.
"""

import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from itertools import islice, pairwise
from pathlib import Path

import numpy as np
from recorded import command_line, write
from walks_on_plans import WalkOnPlan, walks_on_plans

from pdr_est import Config
from pdr_est.estimators import estimate_walk
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.types.measurements import StartPose
from pdr_est.types.on_plan.places import PlacesAt

NEAR_M, SIGMAS = 10.0, 2.0
CLASSES = (0.0, 0.5, 0.8, 0.95, 1.0001)


@dataclass(frozen=True)
class Found:
    """Search for the place of a walk.

    Attributes
    ----------
    name : str
        Name of the walk.
    walked_m, minutes, cpu_s : float
        Length and duration of the walk, and time of the estimator.
    probability, sigma_m, error_m : float
        Most probable place at the end: its probability, its standard deviation and its distance from the truth, m.
    unique_after_m, unique_after_s : float or None
        Since when the place was unique; None if it is not.
    first_after_m : float or None
        When it first seemed to be.
    first_right : bool
        Whether the place was right then.
    """

    name: str
    walked_m: float
    minutes: float
    cpu_s: float
    probability: float
    sigma_m: float
    error_m: float
    unique_after_m: float | None
    unique_after_s: float | None
    first_after_m: float | None
    first_right: bool

    @property
    def right(self) -> bool:
        """Tell whether the most probable place at the end is right."""
        return self.error_m < max(NEAR_M, SIGMAS * self.sigma_m)


def search(walk: WalkOnPlan, seed: int) -> Found | None:
    """Search for the place of a walk; None where its plan was left out, because it did not seem to fit."""
    begin = time.process_time()
    given = replace(walk.measurements, measurements=(*walk.measurements.measurements, walk.plan))
    scale = Config().odometry.sigma_length_scale
    track = estimate_walk("particle", [given], StartPose(), scale, particle=ParticleParams(seed=seed))
    cpu_s = time.process_time() - begin
    if track.places is None:
        return None
    places = track.places
    best, since = places.end.modes[0], places.unique_since
    first = next((one for one in places.filtered if one.unique), None)
    return Found(
        walk.name,
        places.end.walked_m,
        walk.minutes,
        cpu_s,
        best.probability,
        best.sigma_m,
        error_m(walk, places.end),
        None if since is None else since.walked_m,
        None if since is None else since.time_s - places.filtered[0].time_s,
        None if first is None else first.walked_m,
        first is not None and error_m(walk, first) < NEAR_M,
    )


def error_m(walk: WalkOnPlan, places: PlacesAt) -> float:
    """Compute the distance of the most probable place from the truth, m."""
    return float(np.hypot(*(np.array(places.modes[0].position_m) - walk.true_place(places.time_s))))


def as_text(results: Sequence[Found | None]) -> str:
    """Write the numbers of all walks."""
    found = [one for one in results if one is not None]
    cost = sum(one.cpu_s for one in found) / sum(one.minutes for one in found)
    lines = [f"{len(results)} searches, {cost:.2f} CPU s/min", f"plan left out: {len(results) - len(found)}"]
    for low, high in pairwise(CLASSES):
        own = [one for one in found if low <= one.probability < high]
        if own:
            stated = np.mean([one.probability for one in own])
            lines.append(
                f"most probable place {low:.2f} to {min(high, 1.0):.2f}: {len(own):3d}, stated {stated:.2f}, "
                f"right {np.mean([one.right for one in own]):.2f}"
            )
    unique = [one for one in found if one.unique_after_m is not None]
    lines.append(f"unique at the end: {len(unique)}, right {sum(one.right for one in unique)}")
    early = [one for one in found if one.first_after_m is not None]
    lines.append(f"unique at any time: {len(early)}, right then {sum(one.first_right for one in early)}")
    for one in sorted(unique, key=lambda one: one.name):
        lines.append(
            f"  {one.name}: after {one.unique_after_m:.0f} of {one.walked_m:.0f} m, {one.unique_after_s:.0f} s; "
            f"{one.probability:.3f}, {one.error_m:.1f} m off"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Search for the places of all walks."""
    defaults = {"--data": Path, "--shortest": 30.0, "--seeds": 1, "--stride": 1}
    options = command_line(__doc__, defaults)
    walks = [walk for walk in walks_on_plans(options.data) if walk.length_m >= options.shortest]
    found = [search(walk, seed) for seed in range(options.seeds) for walk in islice(walks, 0, None, options.stride)]
    write("unknown_start", as_text(found), [None if one is None else asdict(one) for one in found])


if __name__ == "__main__":
    main()
