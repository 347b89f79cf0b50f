"""Step length models on MMPDR's corridor (Tian et al. 2016, Table VII), with simulated people.

    python experiments/mmpdr_table7.py [--people 10] [--seed 0]

As in section IV-C, five men and five women of 1.56 to 1.83 m walk 28 m slowly, moderately and fast with a held phone.
Steps are found with the defaults, once for all models; height and gender are given to the models. The paper tunes
the constant of every model but eq. 2's so that the mean of all distances is 28 m. So do we, by one factor for each
model (eq. 9 has one for each gender), which the table shows: above 1, the default constants give too short a walk.

The simulated steps follow eq. 9 but for habits of 5 % and variations, so that its small STD is no evidence for it.

Writes experiments/results/mmpdr_table7.json and .txt.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from recorded import command_line, write

from pdr_est.config import Config
from pdr_est.front_end.step_length import (
    LENGTH_MODELS,
    Gender,
    LengthModel,
    StepLength,
    StepLengthParams,
    WalkerParams,
)
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import DeviceParams, PathParams, Scenario, SimulatedPerson, sample_person, simulate_walk
from pdr_est.types.steps import Step

DISTANCE_M = 28.0
PACES = (0.70, 1.0, 1.22)  # of the usual cadence; with eq. 9 that makes speeds like the paper's 0.72 to 1.88 m/s
HEIGHTS_M: dict[Gender, tuple[float, float]] = {"male": (1.67, 1.83), "female": (1.56, 1.72)}
PAPER: dict[LengthModel, tuple[float, float, float, float]] = {  # minimum, maximum, median and STD of distances, m
    "static": (22.19, 36.31, 26.92, 3.58),
    "weinberg": (22.70, 33.59, 28.04, 2.69),
    "scarlett": (22.64, 32.04, 28.39, 2.73),
    "mmpdr": (24.56, 32.27, 27.96, 2.30),
}
NUMBERS = ("min", "max", "median", "std")


@dataclass(frozen=True)
class Walk:
    """Steps that were detected in one walk, and its walker."""

    walker: WalkerParams
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class Row:
    """Distances (n,) of all walks by one model, m, after tuning of the lengths by `factor`."""

    distance_m: NDArray[np.float64]
    factor: float

    def numbers(self) -> tuple[float, float, float, float]:
        """Compute minimum, maximum, median and standard deviation, m."""
        d = self.distance_m
        return float(d.min()), float(d.max()), float(np.median(d)), float(d.std(ddof=1))


def main() -> None:
    """Simulate, measure, print and write the table."""
    arguments = command_line(__doc__, {"--people": 10, "--seed": 0})
    table = measured(walks_of(arguments.people, arguments.seed))
    write("mmpdr_table7", as_text(table), as_document(table))


def walks_of(people: int, seed: int) -> list[Walk]:
    """Simulate the walks of every person: men and women in turn, each gender from short to tall."""
    rng = np.random.default_rng([seed, 7])
    pairs = (people + 1) // 2
    walks = []
    for number in range(people):
        gender: Gender = "male" if number % 2 == 0 else "female"
        height_m = float(np.linspace(*HEIGHTS_M[gender], pairs)[number // 2])
        walker = WalkerParams(height_m=height_m, gender=gender)
        person = sample_person(rng)
        walks += [Walk(walker, steps_of(scenario(walker, person, pace, rng))) for pace in PACES]
    return walks


def scenario(walker: WalkerParams, person: SimulatedPerson, pace: float, rng: np.random.Generator) -> Scenario:
    """Simulate one walk along the corridor by a person of that height and gender."""
    cadence_hz = pace * person.gait.cadence_hz
    return Scenario(
        path=PathParams(vertices_m=((0.0, 0.0), (DISTANCE_M, 0.0))),
        gait=replace(person.gait, height_m=walker.height_m, gender=walker.gender, cadence_hz=cadence_hz),
        body=person.body,
        devices=(DeviceParams(carry=person.held),),
        seed=int(rng.integers(2**31)),
    )


def steps_of(walk: Scenario) -> tuple[Step, ...]:
    """Run the front end on the recording of a simulated walk."""
    (device,) = analyse_recording(simulate_walk(walk).recording, Config())
    return device.steps


def measured(walks: list[Walk]) -> dict[LengthModel, Row]:
    """Compute the tuned distances of every model."""
    return {model: tuned(model, walks) for model in LENGTH_MODELS}


def tuned(model: LengthModel, walks: list[Walk]) -> Row:
    """Compute the distances of a model, tuned so that their mean is the truth, as in section IV-C."""
    distance = np.array([distance_m(model, walk) for walk in walks])
    if model == "static":
        return Row(distance, 1.0)
    genders = np.array([walk.walker.gender for walk in walks])
    alike = [genders == gender for gender in HEIGHTS_M] if model == "mmpdr" else [np.ones(len(walks), dtype=bool)]
    factor = np.ones(len(walks))
    for members in alike:
        if members.any():
            factor[members] = DISTANCE_M / distance[members].mean()
    return Row(factor * distance, float(factor.mean()))


def distance_m(model: LengthModel, walk: Walk) -> float:
    """Add up the lengths of the steps of a walk."""
    stage = StepLength(Config().resample.rate_hz, walk.walker, StepLengthParams(model=model))
    return sum(found.length_m for step in walk.steps for found in stage.push(step))


def as_document(table: Mapping[LengthModel, Row]) -> dict[str, object]:
    """Make the document with the numbers of the text and the distance of each walk."""
    return {
        model: {
            "factor": round(row.factor, 4),
            **dict(zip(NUMBERS, (round(number, 2) for number in row.numbers()), strict=True)),
            "paper": dict(zip(NUMBERS, PAPER[model], strict=True)) if model in PAPER else None,
            "distance_m": [round(float(distance), 2) for distance in row.distance_m],
        }
        for model, row in table.items()
    }


def as_text(table: Mapping[LengthModel, Row]) -> str:
    """Format a line for each model: the numbers of the paper, then ours."""
    walks = len(next(iter(table.values())).distance_m)
    heading = "".join(f"{number:>8}" for number in NUMBERS)
    lines = [
        f"MMPDR Table VII, distances of {walks} walks of {DISTANCE_M:g} m in metres, constants tuned to the mean",
        "",
        f"{'':14}{'paper':>32}{'simulated':>34}",
        f"{'':14}{heading}  {heading}{'factor':>8}",
    ]
    for model, row in table.items():
        paper = "".join(f"{number:8.2f}" for number in PAPER[model]) if model in PAPER else f"{'-':>8}" * len(NUMBERS)
        lines.append(f"{model:14}{paper}  {''.join(f'{n:8.2f}' for n in row.numbers())}{row.factor:8.3f}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
