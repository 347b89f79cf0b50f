"""Fit of the step-length model `harmonic`, and its errors on the data sets that were left out of the fit.

    python experiments/step_length_fit.py --data DIR

DIR holds the folders of the benchmark suites and `walks`, a folder of NAME.csv with NAME.truth.csv or a belt speed in
NAME.json. For each walk of at least 15 m, the logarithm of the true length per step is regressed on the means of the
logarithms of the first harmonic, the upper values and the duration; the effect of turning is fixed at what the
stretches within walks show. Walks of one placement in one data set share an error, and large residuals weigh less.
All recordings of a data set are left out together, and both parts of OxIOD. Left out of every fit: runners, stairs,
and walks with many steps missed. Writes results/step_length_fit.txt and .json.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from recorded import command_line, write

from pdr_est.config import Config
from pdr_est.errors import PdrError
from pdr_est.evaluate.position_errors import polyline_length, thinned
from pdr_est.evaluate.stride_lengths import scored_strides, step_shares
from pdr_est.experiment.config import DataParams
from pdr_est.experiment.suites import suite_named
from pdr_est.experiment.walks import find_walks
from pdr_est.frames import Array
from pdr_est.front_end.step_length import HarmonicParams, StepLengthParams
from pdr_est.front_end.step_length.harmonic_model import LEAST_SAMPLES, TurnMeter, log_features, walked_part
from pdr_est.io import read
from pdr_est.pipeline.front_end_chain import analyse_device
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.recording import Recording
from pdr_est.types.steps import Step

SUITES = ("ilc20", "oxiod", "phone-gps", "ipin2023", "known-distance", "stride-length")
SETS = ("dsads", "humolire", "oxiod-vicon", "phyphox-gps", "rfbr", "ridi", "xdr23", "xdr25")
RUNNING = ("a12_", "running")
MISSED = ("rightarm", "fm2")
FAMILY = {"oxiod-vicon": "oxiod"}  # sets that are left out together
GPS = ("phone-gps", "phyphox-gps")
LEAST_LENGTH_M = 15.0
SIGMA_TRUTH_M = {"ilc20": 1.0, "ipin2023": 1.0, "humolire": 1.0, "phone-gps": 4.0, "phyphox-gps": 4.0}  # else 0.5
SIGMA_PLACEMENT, SIGMA_WALK = 0.06, 0.06  # of the logarithm of the length
SIGMA_RESIDUAL, HUBER = 0.10, 1.3
FRAGMENT = (0.7, 0.6, -0.7)
COLUMNS = ("intercept", "harmonic", "push", "duration")


@dataclass(frozen=True)
class Case:
    """A walk of known length.

    Attributes
    ----------
    data_set, placement, name : str
        Names.
    length_m : float
        True length.
    shares : Array
        Part (n,) of each step that lies within it.
    features : Array
        Logarithms of first harmonic, upper values and duration of each step, (n, 3).
    offset : Array
        Known effects (n,) on the logarithm of each length: of turning, and of intervals shorter than any step.
    log_height : float
        Logarithm of the height over the model's, 0 where it is not known; a fit uses it, an error does not.
    earlier_m : Array
        Lengths (n,) by the model `walk-run`.
    """

    data_set: str
    placement: str
    name: str
    length_m: float
    shares: Array
    features: Array
    offset: Array
    log_height: float
    earlier_m: Array

    @property
    def family(self) -> str:
        """Name of what is left out together."""
        return FAMILY.get(self.data_set, self.data_set)

    @property
    def is_fitted(self) -> bool:
        """True if the walk may take part in a fit."""
        return not is_running(self.name) and not any(part in self.name for part in MISSED)

    @property
    def sigma(self) -> float:
        """Standard deviation of the logarithm of the true length."""
        return SIGMA_TRUTH_M.get(self.data_set, 0.5) / self.length_m

    def equation(self) -> tuple[Array, float]:
        """Return the mean features with a leading 1, (4,), and the logarithm of the length per step."""
        mean = np.average(self.features, axis=0, weights=self.shares)
        known = float(np.average(self.offset, weights=self.shares))
        return np.concatenate([[1.0], mean]), float(
            np.log(self.length_m / self.shares.sum())
        ) - known - self.log_height

    def log_ratio(self, constants: Array) -> float:
        """Compute ln(modelled / true length)."""
        lengths_m = np.exp(constants[0] + self.features @ constants[1:] + self.offset)
        return float(np.log(self.shares @ lengths_m / self.length_m))


def main() -> None:
    """Fit with each set left out and with all, and write constants and errors."""
    cases = [
        case for case in all_cases(command_line(__doc__, {"--data": Path}).data) if case.length_m >= LEAST_LENGTH_M
    ]
    left_out = {
        family: fit([case for case in cases if case.family != family and case.is_fitted])
        for family in sorted({case.family for case in cases})
    }
    constants = fit([case for case in cases if case.is_fitted])
    rows = [row(placement, members, left_out, constants) for placement, members in by_placement(cases).items()]
    fitted = [case for case in cases if case.is_fitted]
    rows.append(row("all that are fitted", fitted, left_out, constants))
    head = ("placement", "walks", "left out: mean", "rms", "walk-run: mean", "rms", "fitted: mean", "rms")
    lines = [f"{name:>10} {value:7.3f}" for name, value in zip(COLUMNS, constants, strict=True)]
    table = "\n".join(
        "".join(f"{cell:>{27 if column == 0 else 16}}" for column, cell in enumerate(cells))
        for cells in (head, *rows)
    )
    spread = placement_spread(cases, left_out)
    text = "\n".join([*lines, f"{'spread of placements, left out':>30} {spread:.3f}", "", table]) + "\n"
    document = {
        "constants": dict(zip(COLUMNS, constants.tolist(), strict=True)),
        "spread_of_placements": spread,
        "left_out": {
            f"{case.placement}/{case.name}": case.log_ratio(left_out[case.family]) for case in cases if case.is_fitted
        },
    }
    write("step_length_fit", text, document)


def fit(cases: list[Case]) -> Array:
    """Fit the constants (4,) by weighted least squares, in which large residuals weigh less."""
    design, target = (np.array(part) for part in zip(*(case.equation() for case in cases), strict=True))
    own = np.array([SIGMA_WALK**2 + case.sigma**2 for case in cases])
    information = {
        name: sum(1.0 / (SIGMA_WALK**2 + case.sigma**2) for case in members)
        for name, members in by_placement(cases).items()
    }
    weight = np.array(
        [1.0 / v / (1.0 + SIGMA_PLACEMENT**2 * information[c.placement]) for v, c in zip(own, cases, strict=True)]
    )
    scale = np.array([np.hypot(SIGMA_RESIDUAL, case.sigma) for case in cases])
    trust = np.ones(len(cases))
    for _ in range(10):
        weighted = design.T * (weight * trust)
        constants: Array = np.linalg.solve(weighted @ design, weighted @ target)
        residual = np.abs(design @ constants - target) / scale
        trust = np.minimum(1.0, HUBER / np.maximum(residual, 1e-9))
    return constants


def by_placement(cases: list[Case]) -> Mapping[str, list[Case]]:
    """Sort the walks by data set and placement."""
    return {name: [c for c in cases if c.placement == name] for name in sorted({c.placement for c in cases})}


def row(name: str, cases: list[Case], left_out: Mapping[str, Array], constants: Array) -> tuple[str, ...]:
    """Make a row of the table."""
    out = np.array([case.log_ratio(left_out[case.family]) for case in cases])
    earlier = np.array([np.log(case.shares @ case.earlier_m / case.length_m) for case in cases])
    fitted = np.array([case.log_ratio(constants) for case in cases])
    numbers = (out.mean(), np.sqrt(np.mean(out**2)), earlier.mean(), np.sqrt(np.mean(earlier**2)))
    numbers += (fitted.mean(), np.sqrt(np.mean(fitted**2)))
    return (name, str(len(cases)), *(f"{value:.3f}" for value in numbers))


def placement_spread(cases: list[Case], left_out: Mapping[str, Array]) -> float:
    """Compute the root mean square of all left-out errors, with equal weight of the placements."""
    groups = by_placement([case for case in cases if case.is_fitted]).values()
    squares = [np.mean([case.log_ratio(left_out[case.family]) ** 2 for case in members]) for members in groups]
    return float(np.sqrt(np.mean(squares)))


def all_cases(data: Path) -> Iterator[Case]:
    """Read and analyse the walks of the suites and of the folder `walks`."""
    for name in SUITES:
        suite = suite_named(name)
        for walk in find_walks(DataParams(suite=name), data, suite):
            yield from cases_of(name, walk.name, walk.labels.get("group", ""), walk.recording(suite), {})
    for name in SETS:
        for note in sorted((data / "walks" / name).glob("*.json")):
            known = json.loads(note.read_text(encoding="utf-8"))
            recording = with_positions(read(note.with_name(f"{note.stem}.csv.gz")), note.with_suffix(".truth.csv"))
            group = f"{known.get('carrying', '')}{' running' if is_running(note.stem) else ''}"
            yield from cases_of(name, note.stem, group, recording, known)


def is_running(name: str) -> bool:
    """Tell whether a walk is a run."""
    return any(part in name for part in RUNNING)


def cases_of(
    data_set: str, name: str, group: str, recording: Recording, known: Mapping[str, object]
) -> Iterator[Case]:
    """Analyse a recording, with the lengths of the earlier model."""
    config = replace(Config(), step_length=StepLengthParams(model="walk-run"))
    for device in recording.devices:
        try:
            steps = analyse_device(device, name, config).steps
        except PdrError as error:
            print(f"{data_set}/{name}: {error}")
            continue
        length_m, shares = true_length(data_set, name, recording, known, steps)
        meter = TurnMeter()
        turn_rad = np.array([meter.at(step) for step in steps])
        part = np.array([walked_part(HarmonicParams(), step.event.time_s - step.start_s) for step in steps])
        short = 0.0 if is_running(name) else np.log(part)
        height = float(np.log(float(str(known["height_m"])) / 1.73)) if "height_m" in known else 0.0
        kept = shares > 0.0
        yield Case(
            data_set,
            f"{data_set}/{group}" if group else data_set,
            name,
            length_m,
            shares[kept],
            np.array([features(step) for step in steps])[kept],
            (short - HarmonicParams().turn_per_rad * turn_rad)[kept],
            height,
            np.array([step.length_m for step in steps])[kept],
        )


def features(step: Step) -> tuple[float, float, float]:
    """Compute the features of a step; typical ones for a fragment."""
    if len(step.samples) < LEAST_SAMPLES:
        return FRAGMENT
    return log_features(step.event.time_s - step.start_s, step.samples.vertical_mps2)


def true_length(
    data_set: str, name: str, recording: Recording, known: Mapping[str, object], steps: tuple[Step, ...]
) -> tuple[float, Array]:
    """Return the true length, m, and the part (n,) of each step within it."""
    start_s, end_s = (np.array(t) for t in zip(*((s.start_s, s.event.time_s) for s in steps), strict=True))
    truth = recording.truth
    if truth.strides is not None:
        strides = scored_strides(truth.strides)
        return float(strides.length_m.sum()), np.minimum(step_shares(start_s, end_s, strides).sum(axis=0), 1.0)
    if truth.distance_m is not None:
        return truth.distance_m, np.ones(len(steps))
    if "speed_mps" in known:
        return float(str(known["speed_mps"])) * (end_s[-1] - end_s[0]), np.concatenate(
            [[0.0], np.ones(len(steps) - 1)]
        )
    time_s, position_m = positions(recording)
    least_m = 5.0 if data_set in GPS else 0.3 if np.median(np.diff(time_s)) < 0.6 else 0.0
    kept = thinned(position_m, least_m)
    first_s, last_s = time_s[kept[0]], time_s[kept[-1]]
    within = np.minimum(end_s, last_s) - np.maximum(start_s, first_s)
    return polyline_length(position_m[kept]), np.clip(within / np.maximum(end_s - start_s, 1e-6), 0.0, 1.0)


def with_positions(recording: Recording, table: Path) -> Recording:
    """Add the true positions of a table time_s, x_m, y_m, if it is there."""
    if not table.exists():
        return recording
    time_s, x_m, y_m = np.loadtxt(table, delimiter=",", skiprows=1, unpack=True)
    known = TruePositions(time_s=time_s, position_m=np.column_stack([x_m, y_m]), sigma_m=0.5, source="table")
    return replace(recording, truth=replace(recording.truth, positions=known))


def positions(recording: Recording) -> tuple[Array, Array]:
    """Return times and true positions of a recording; GPS fixes where there are no others."""
    if recording.truth.positions is not None:
        return recording.truth.positions.time_s, recording.truth.positions.position_m
    fixes = [fix for fix in recording.fixes if fix.source == "gps"]
    return np.array([fix.time_s for fix in fixes]), np.array([fix.position_m for fix in fixes])


if __name__ == "__main__":
    main()
