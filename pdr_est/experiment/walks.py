"""The walks of an experiment: found on disk or drawn from a seed, each with the keys that it may be grouped by."""

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
from pdr_est.types.ground_truth import Truth
from pdr_est.types.recording import Recording


def with_truth(recording: Recording, told: Truth) -> Recording:
    """The recording with what the data set tells of it elsewhere."""
    known = {part.name: getattr(told, part.name) for part in fields(told) if getattr(told, part.name) is not None}
    return replace(recording, truth=replace(recording.truth, **known))


@dataclass(frozen=True)
class Walk:
    """One walk, and so one piece of work. labels: keys to group by -> value. source: what to read or to simulate.
    truth_every_s: of a simulated walk."""

    name: str
    labels: Mapping[str, str]
    source: WalkFile | Scenario
    truth_every_s: float = 0.0

    def recording(self, suite: Suite) -> Recording:
        """The recording with its truth. Raises RecordingError when it cannot be read."""
        if isinstance(self.source, WalkFile):
            return with_truth(suite.prepare(read(self.source.path)), self.source.truth)
        return _with_sparse_truth(simulate_walk(self.source).recording, self.truth_every_s)


def find_walks(data: DataParams, folder: Path, suite: Suite | None, seed: int) -> tuple[Walk, ...]:
    """The walks that the data section asks for, in order of name; simulated ones in order of number.

    Raises ConfigError for a preset that is unknown or patterns that leave nothing, RecordingError for a folder that
    is missing.
    """
    if data.simulated is not None:
        first = None if data.only else data.limit  # a large population takes its time
        walks = _simulated(data.simulated, seed, first)
    elif suite is not None:
        walks = [_from_file(file) for file in suite.find(suite_folder(folder, suite.folder))]
    else:
        walks = _matching(folder, data.recordings)
    if data.only:
        walks = [walk for walk in walks if any(fnmatchcase(walk.name, pattern) for pattern in data.only)]
    return tuple(walks[: data.limit])


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
    """The walks of the section. limit: more than so many are not needed."""
    if parameters.presets and parameters.series:
        raise ConfigError("presets and series are given: name one of them")
    for what in ("presets", "series"):
        names: Sequence[str] = getattr(parameters, what)
        if len(set(names)) < len(names):
            more = "repeats" if what == "presets" else "number"
            raise ConfigError(f"{what} {', '.join(names)}: one stands twice: use {more} instead")
    chosen = seed if parameters.seed is None else parameters.seed
    every_s = parameters.truth_every_s
    number = min(parameters.number, limit or parameters.number)
    if parameters.series:
        return [
            Walk(f"{series}/{scenario.name}", {"series": series}, scenario, every_s)
            for series in parameters.series
            for scenario in _of_series(series, number, chosen)
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
        Walk(f"{name}/{number + 1}", {"preset": name}, _again(preset(name), chosen, number), every_s)
        for name in parameters.presets
        for number in range(parameters.repeats)
    ]


def _of_series(series: Series, number: int, seed: int) -> tuple[Scenario, ...]:
    match series:
        case "robust-dr":
            return robust_dr_trials(seed, number)
        case "psp-I":
            return psp_walks("I", number, seed)
        case "psp-II":
            return psp_walks("II", number, seed)


def _again(scenario: Scenario, seed: int, number: int) -> Scenario:
    """The scenario with errors of its own; presets keep their order, so that the names tell which is which."""
    place = list(PRESETS).index(scenario.name) if scenario.name in PRESETS else 0
    return replace(scenario, seed=int(np.random.default_rng([seed, place, number]).integers(2**31)))


def _with_sparse_truth(recording: Recording, every_s: float) -> Recording:
    """True positions at every_s from the first on and at the end, as waypoints would have them."""
    truth = recording.truth.positions
    if truth is None:
        return recording
    wanted_s = np.arange(truth.time_s[0], truth.time_s[-1], every_s)
    kept = np.unique([*np.searchsorted(truth.time_s, wanted_s - 1e-9), len(truth.time_s) - 1])
    sparse = replace(truth, time_s=truth.time_s[kept], position_m=truth.position_m[kept])
    return replace(recording, truth=replace(recording.truth, positions=sparse))
