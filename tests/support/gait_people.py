"""Made-up people for the gait model: features of steps around a point of each gait, a little elsewhere for each."""

import numpy as np

from pdr_est.front_end.gait.training_data import LabelledSteps
from pdr_est.types.steps import Gait

CENTRES = {
    Gait.WALKING: (1.2, 1.3, -0.6, 1.2, -7.0, 0.48),
    Gait.JOGGING: (2.3, 2.2, -0.9, 1.6, -14.0, 0.47),
    Gait.RUNNING: (2.5, 2.4, -1.0, 2.0, -17.0, 0.45),
}


def walks_of(people: int, steps: int = 60, joggers_only: int = 0, seed: int = 0) -> list[LabelledSteps]:
    """Walking, jogging and running of some people, walking and jogging of some more."""
    rng = np.random.default_rng(seed)
    walks = []
    for number in range(people + joggers_only):
        offset = 0.05 * rng.standard_normal(6)
        gaits = list(CENTRES) if number < people else [Gait.WALKING, Gait.JOGGING]
        for gait in gaits:
            spread = rng.standard_normal((steps, 6)) * (0.12, 0.12, 0.05, 0.15, 1.0, 0.02)
            features = np.round(np.array(CENTRES[gait]) + offset + spread, 6)
            begins = np.arange(steps) % 20 == 0
            data_set = "both" if number < people else "jogging"
            walks.append(LabelledSteps(f"{data_set}/{number}", data_set, gait, features, begins))
    return walks
