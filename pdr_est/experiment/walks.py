"""Walks of a benchmark or an experiment: found on disk or simulated, with the keys that they may be grouped by."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.experiment.config import DataParams, Series, SimulatedParams
from pdr_est.experiment.recording_files import recordings, suite_folder
from pdr_est.experiment.suite import Suite, WalkFile
from pdr_est.io import read
from pdr_est.simulate import PRESETS, Scenario, preset, psp_walks, robust_dr_trials, simulate_walk
from pdr_est.simulate.people.population import sample_population
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.ground_truth import Truth
from pdr_est.types.recording import Recording


@dataclass(frozen=True)
class Walk:
    """One walk, which is one piece of work.

    Attributes
    ----------
    name : str
        Name in the results.
    labels : Mapping
        Keys to group by -> value.
    source : WalkFile or Scenario
        Recording to read, or walk to simulate.
    truth_every_s : float
        Time between the true positions of a simulated walk, s.
    """

    name: str
    labels: Mapping[str, str]
    source: WalkFile | Scenario
    truth_every_s: float = 0.0

    def recording(self, suite: Suite) -> Recording:
        """Read or simulate the recording with its ground truth.

        Raises
        ------
        RecordingError
            If the recording cannot be read.
        """
        if isinstance(self.source, WalkFile):
            recording = _with_stated_truth(suite.prepare(read(self.source.path)), self.source.truth)
            return _with_stated_truth(recording, suite.truth_beside(self.source.path))
        return _with_sparse_truth(simulate_walk(self.source).recording, self.truth_every_s)

    def floor_plan(self, suite: Suite) -> FloorPlan | None:
        """Read the floor plan of the walk; None where there is none beside the recording.

        Raises
        ------
        FloorPlanError
            If it cannot be used.
        """
        return suite.plan_beside(self.source.path) if isinstance(self.source, WalkFile) else None

    def walker_height_m(self, suite: Suite) -> float | None:
        """Read the height of the walker, m; None where it is not known beside the recording.

        Raises
        ------
        RecordingError
            If it is no height of a person.
        """
        return suite.walker_height(self.source.path) if isinstance(self.source, WalkFile) else None


def find_walks(data: DataParams, folder: Path, suite: Suite | None, seed: int = 0) -> tuple[Walk, ...]:
    """Find the walks that the data section asks for.

    Parameters
    ----------
    data : DataParams
        The data section.
    folder : Path
        Folder of the recordings.
    suite : Suite, optional
        The suite that is named in the section.
    seed : int
        Seed of the simulated walks.

    Returns
    -------
    tuple of Walk
        Recorded walks in order of name, simulated ones in order of number.

    Raises
    ------
    ConfigError
        For a preset that is unknown, or patterns that match nothing.
    RecordingError
        For a folder that does not exist.
    """
    if data.simulated is not None:
        first = None if data.only else data.limit  # to simulate a large population takes time
        walks = _simulated(data.simulated, seed, first)
    elif suite is not None:
        walks = [_from_file(file) for file in suite.find(suite_folder(folder, suite.folder))]
    else:
        walks = _matching(folder, data.recordings)
    if data.only:
        walks = [walk for walk in walks if any(fnmatchcase(walk.name, pattern) for pattern in data.only)]
    return tuple(walks[: data.limit])


def _with_stated_truth(recording: Recording, stated: Truth) -> Recording:
    """Add the ground truth that the data set states outside of the recording."""
    known = {part.name: value for part in fields(stated) if (value := getattr(stated, part.name)) is not None}
    return replace(recording, truth=replace(recording.truth, **known))


def _from_file(file: WalkFile) -> Walk:
    labels = {key: value or "unknown" for key, value in file.labels.items()}
    if file.group is not None:
        labels["group"] = file.group
    return Walk(file.name, {**_folder_label(file.name), **labels}, file)


def _folder_label(name: str) -> dict[str, str]:
    folder = name.rpartition("/")[0]
    return {"folder": folder} if folder else {}


def _matching(folder: Path, patterns: Sequence[str]) -> list[Walk]:
    found: dict[str, Path] = {}
    for pattern in patterns:
        if not pattern or Path(pattern).is_absolute() or ".." in Path(pattern).parts:
            raise ConfigError(f"recordings: {pattern!r} is no pattern inside of data.folder: set the folder instead")
        matching = dict(recordings(folder, pattern))
        if not matching:
            raise ConfigError(f"recordings: nothing in {folder} matches {pattern!r}: correct it or the folder")
        for name in matching.keys() & found.keys():
            if matching[name] != found[name]:
                files = f"{found[name].name} and {matching[name].name}"
                raise ConfigError(f"recordings: {files} would both be the walk {name!r}: rename one or leave one out")
        found |= matching
    return [Walk(name, _folder_label(name), WalkFile(name, path)) for name, path in sorted(found.items())]


def _simulated(parameters: SimulatedParams, seed: int, limit: int | None) -> list[Walk]:
    """Make the walks of the section, not many more than `limit`."""
    if parameters.presets and parameters.series:
        raise ConfigError("presets and series are given: name one of them")
    for key, names, remedy in (
        ("presets", parameters.presets, "repeats"),
        ("series", parameters.series, "number"),
    ):
        if len(set(names)) < len(names):
            raise ConfigError(f"{key} {', '.join(names)}: one stands twice: use {remedy} instead")
    chosen = seed if parameters.seed is None else parameters.seed
    every_s = parameters.truth_every_s
    number = min(parameters.number, limit or parameters.number)
    if parameters.series:
        return [
            Walk(f"{series}/{scenario.name}", {"series": series}, scenario, every_s)
            for series in parameters.series
            for scenario in _scenarios_of_series(series, number, chosen)
        ]
    if not parameters.presets:
        return [
            Walk(
                member.scenario.name,
                {"person": f"{member.person:03d}", "carrying": "-".join(member.carrying)},
                member.scenario,
                every_s,
            )
            for member in sample_population(replace(parameters, number=number), seed)
        ]
    return [
        Walk(f"{name}/{number + 1}", {"preset": name}, _with_own_seed(preset(name), chosen, number), every_s)
        for name in parameters.presets
        for number in range(parameters.repeats)
    ]


def _scenarios_of_series(series: Series, number: int, seed: int) -> tuple[Scenario, ...]:
    if series == "robust-dr":
        return robust_dr_trials(seed, number)
    return psp_walks("I" if series == "psp-I" else "II", number, seed)


def _with_own_seed(scenario: Scenario, seed: int, number: int) -> Scenario:
    """Give a repetition of a preset its own sensor errors; they depend on the place of the preset in `PRESETS`."""
    place = list(PRESETS).index(scenario.name) if scenario.name in PRESETS else 0
    return replace(scenario, seed=int(np.random.default_rng([seed, place, number]).integers(2**31)))


def _with_sparse_truth(recording: Recording, every_s: float) -> Recording:
    """Keep the true positions every so many seconds and at the end, like waypoints."""
    truth = recording.truth.positions
    if truth is None:
        return recording
    wanted_s = np.arange(truth.time_s[0], truth.time_s[-1], every_s)
    kept = np.unique([*np.searchsorted(truth.time_s, wanted_s - 1e-9), len(truth.time_s) - 1])
    sparse = replace(truth, time_s=truth.time_s[kept], position_m=truth.position_m[kept])
    return replace(recording, truth=replace(recording.truth, positions=sparse))
