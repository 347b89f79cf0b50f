"""Reading of an experiment file; all of it is checked before anything runs."""

import dataclasses
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml
from pydantic import TypeAdapter, ValidationError

from pdr_est.config import config_to_dict
from pdr_est.errors import ConfigError, PdrError
from pdr_est.experiment.config import DataParams, ExperimentConfig
from pdr_est.experiment.scoring.experiment_suite import experiment_suite
from pdr_est.experiment.scoring.positions import HELDOUT_METRICS
from pdr_est.experiment.suite import Suite
from pdr_est.experiment.suites import SUITES, suite_named
from pdr_est.experiment.variants.axes import TRACK_FILES, Variant
from pdr_est.experiment.variants.expand import expand
from pdr_est.experiment.walks import Walk, find_walks
from pdr_est.params.validation_messages import Location, explain, nearest
from pdr_est.params.yaml_lines import Lines, load_yaml_lines
from pdr_est.simulate import PRESETS

ADAPTER = TypeAdapter(ExperimentConfig)
_TRACK_KEYS = ("track", "mode")  # keys to group by that every track has


@dataclass(frozen=True)
class Experiment:
    """A checked experiment.

    Attributes
    ----------
    path : Path
        The experiment file.
    config : ExperimentConfig
        Its sections.
    folder : Path
        Folder of the recordings.
    suite : Suite
        Rules of scoring.
    variants : tuple of Variant
        Settings to compare.
    walks : tuple of Walk
        At least one walk.
    metrics : tuple of str
        Metrics in the results.
    """

    path: Path
    config: ExperimentConfig
    folder: Path
    suite: Suite
    variants: tuple[Variant, ...]
    walks: tuple[Walk, ...]
    metrics: tuple[str, ...]

    @property
    def title(self) -> str:
        """Title of the report."""
        return self.config.title or self.path.stem

    def resolved(self) -> dict[str, Any]:
        """Make an experiment file, as plain dictionaries, that contains every setting of every variant."""
        variants: dict[str, dict[str, Any] | None] = {
            variant.name: config_to_dict(variant.config)
            if variant.track_files is None
            else {TRACK_FILES: variant.track_files}
            for variant in self.variants
        }
        plain = dataclasses.asdict(
            replace(self.config, settings_file=None, settings={}, variants=variants, sweep={}, metrics=self.metrics)
        )
        if self.config.data.simulated is None:
            plain["data"]["folder"] = str(self.folder.resolve())
        return {key: _lists(value) for key, value in plain.items()}

    def to_yaml(self) -> str:
        """Write the resolved experiment file as text."""
        return str(yaml.safe_dump(self.resolved(), sort_keys=False, allow_unicode=True))


def load_experiment(path: str | Path, data: Path | None = None, limit: int | None = None) -> Experiment:
    """Read and check an experiment file.

    Parameters
    ----------
    path : str or Path
        The experiment file.
    data : Path, optional
        Folder of the recordings, instead of the one in the file.
    limit : int, optional
        Largest number of walks.

    Raises
    ------
    ConfigError
        In one line with the file, the line and the remedy: for unknown keys and names, values out of range, files and
        folders that do not exist, and settings that contradict each other.
    """
    path = Path(path)
    content, lines = load_yaml_lines(path)
    config = parse(content, path, lines)
    if limit is not None:
        config = replace(config, data=replace(config.data, limit=min(limit, config.data.limit or limit)))
    benchmark = _suite(config.data, path, lines)
    _check_fixes(config, benchmark, path, lines)
    suite = experiment_suite(benchmark, config.fixes.protocol)
    variants = expand(config, path, lines)
    metrics = _metrics(config, suite, path, lines)
    folder = path.parent / config.data.folder if data is None else data
    walks = _walks(config, folder, benchmark, path, lines)
    _check_groups(config, walks, path, lines)
    for key in ("metrics", "group_by"):
        _refuse_twice(getattr(config, key), (key,), path, lines)
    return Experiment(path, config, folder, suite, variants, walks, metrics)


def parse(content: Any, path: Path, lines: Lines) -> ExperimentConfig:
    """Validate the sections of a file.

    Raises
    ------
    ConfigError
        For unknown keys and values out of range.
    """
    if not isinstance(content, dict) or "data" not in content:
        raise ConfigError(f"{path}: is no experiment: it needs a section `data` with the walks")
    try:
        return ADAPTER.validate_python(content)
    except ValidationError as error:
        raise ConfigError(f"{path}: {explain(error, ExperimentConfig, lines.words)}") from error


def _suite(data: DataParams, path: Path, lines: Lines) -> Suite | None:
    given = [name for name in ("suite", "recordings", "simulated") if getattr(data, name)]
    if data.simulated is not None and "simulated" not in given:
        given.append("simulated")
    if len(given) != 1:
        words = "none is given, or nothing below it" if not given else f"{' and '.join(given)} are given"
        raise ConfigError(f"{path}: {lines.words(('data',))}data: {words}: name one of suite, recordings, simulated")
    if data.simulated is not None:
        for place, name in enumerate(data.simulated.presets):
            where: Location = ("data", "simulated", "presets", place)
            _refuse_unknown(name, list(PRESETS), "simulated walk", path, lines.words(where))
    if data.suite is None:
        return None
    _refuse_unknown(data.suite, [suite.name for suite in SUITES], "suite", path, lines.words(("data", "suite")))
    return suite_named(data.suite)


def _check_fixes(config: ExperimentConfig, suite: Suite | None, path: Path, lines: Lines) -> None:
    if config.fixes.protocol != "none" and suite is not None and suite.fixes is None:
        where = lines.words(("fixes", "protocol"))
        raise ConfigError(
            f"{path}: {where}fixes.protocol = {config.fixes.protocol!r}: suite {suite.name} knows no true positions: "
            "set it to none"
        )


def _metrics(config: ExperimentConfig, suite: Suite, path: Path, lines: Lines) -> tuple[str, ...]:
    for place, name in enumerate(config.metrics):
        where = lines.words(("metrics", place))
        if name in HELDOUT_METRICS and name not in suite.metrics:
            raise ConfigError(f"{path}: {where}metric {name} needs fixes: set fixes.protocol to heldout or every")
        _refuse_unknown(name, list(suite.metrics), "metric", path, where)
    return config.metrics or suite.metrics


def _walks(config: ExperimentConfig, folder: Path, suite: Suite | None, path: Path, lines: Lines) -> tuple[Walk, ...]:
    section: Location = ("data", "folder")
    if config.data.simulated is None and not folder.is_dir():
        raise ConfigError(
            f"{path}: {lines.words(section)}data folder {folder}: no such folder: correct it or give --data DIR"
        )
    try:
        walks = find_walks(config.data, folder, suite, config.seed)
    except PdrError as error:
        raise ConfigError(f"{path}: {lines.words(('data',))}{error}") from error
    if not walks:
        what = "only" if config.data.only else "folder"
        where = lines.words(("data", what))
        raise ConfigError(f"{path}: {where}data: no walk found in {folder}: correct {what} or give --data DIR")
    return walks


def _check_groups(config: ExperimentConfig, walks: Iterable[Walk], path: Path, lines: Lines) -> None:
    known = list(dict.fromkeys([*(key for walk in walks for key in walk.labels), *_TRACK_KEYS]))
    for place, key in enumerate(config.group_by):
        _refuse_unknown(key, known, "key to group by", path, lines.words(("group_by", place)))


def _refuse_twice(names: Sequence[str], section: Location, path: Path, lines: Lines) -> None:
    for place, name in enumerate(names):
        if name in names[:place]:
            raise ConfigError(f"{path}: {lines.words((*section, place))}{name} stands twice: remove one")


def _refuse_unknown(name: str, known: list[str], what: str, path: Path, where: str) -> None:
    if name not in known:
        raise ConfigError(f"{path}: {where}unknown {what} {name!r}: {nearest(name, known)}")


def _lists(value: Any) -> Any:
    """Replace tuples by lists, as YAML has them."""
    if isinstance(value, dict):
        return {key: _lists(inner) for key, inner in value.items()}
    return [_lists(inner) for inner in value] if isinstance(value, list | tuple) else value
