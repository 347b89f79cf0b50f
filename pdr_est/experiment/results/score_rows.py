"""The outcome of a benchmark: a row for each scored track, and the averages over them."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pdr_est.evaluate.statistics import Average
from pdr_est.experiment.scoring.confusion import Confusion

Json = dict[str, Any]


@dataclass(frozen=True)
class WalkRow:
    """One scored track. metrics: name -> value, None when it cannot be told. seconds: CPU time of the chain.

    settings: value on each axis that benchmarks compare, by the axis' word. labels, group, headline: of the
    `suite.WalkFile`. counts: how many points stand behind the metrics. predicted: how many steps got each label.
    """

    walk: str
    track: str
    settings: Mapping[str, str]
    mode: str
    metrics: Mapping[str, float | None]
    seconds: float
    labels: Mapping[str, str | None] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)
    group: str | None = None
    headline: bool = True
    predicted: Mapping[str, int] = field(default_factory=dict)

    def to_dict(self) -> Json:
        """The row as it stands in the JSON document."""
        return {
            "walk": self.walk,
            "track": self.track,
            **self.settings,
            "mode": self.mode,
            **self.labels,
            **self.metrics,
            **self.counts,
            **({"predicted": dict(self.predicted)} if self.predicted else {}),
            "seconds": self.seconds,
        }


Pool = Callable[[Sequence[WalkRow]], Mapping[str, Confusion]]
"""From the rows of one variant: confusions by what they are of."""


def no_confusion(_rows: Sequence[WalkRow]) -> Mapping[str, Confusion]:
    """`Pool` of a suite without labels."""
    return {}


@dataclass(frozen=True)
class SkippedWalk:
    """A walk that could not be scored, or a metric of it ("metric: reason")."""

    walk: str
    reason: str


Summary = dict[str, Average]


@dataclass(frozen=True)
class BenchmarkResult:
    """All rows of a suite. axis: word of the setting that was compared. names: its values that were run.
    settings: the value on each axis that the plain summary is of, by the axis' word. pool: of the `suite.Suite`."""

    suite: str
    version: str
    axis: str
    names: tuple[str, ...]
    settings: Mapping[str, str]
    metrics: tuple[str, ...]
    rows: tuple[WalkRow, ...]
    skipped: tuple[SkippedWalk, ...]
    pool: Pool = no_confusion

    def summary(self, name: str) -> Summary:
        """Averages over the headline walks of a variant, by metric."""
        return self._averages(row for row in self._rows_of(name) if row.headline)

    def groups(self, name: str) -> dict[str, Summary]:
        """Averages of a variant over each group of walks, by group; empty when the suite has no groups."""
        rows = [row for row in self._rows_of(name) if row.group is not None]
        groups = sorted({row.group for row in rows if row.group is not None})
        return {group: self._averages(row for row in rows if row.group == group) for group in groups}

    def confusions(self, name: str) -> Mapping[str, Confusion]:
        """Which class of step a variant took for which, by what it is of; empty for a suite without classes."""
        return self.pool(self._rows_of(name))

    def to_dict(self) -> Json:
        """The JSON document. With several variants the axis' value is "all", `summary` and `groups` are of the
        configured one, and, on the axis "estimator", `estimators` and `estimator_groups` hold those of each. A suite
        with classes has `confusion` beside `groups`, and so for each variant.
        """
        main = self.settings[self.axis]
        document: Json = {
            "suite": self.suite,
            "version": self.version,
            **self.settings,
            "summary": _plain(self.summary(main)),
            "groups": _plain_groups(self.groups(main)),
        }
        if len(self.names) > 1:
            document[self.axis] = "all"
            document[f"{self.axis}s"] = {name: _plain(self.summary(name)) for name in self.names}
            document[f"{self.axis}_groups"] = {name: _plain_groups(self.groups(name)) for name in self.names}
        document |= self._confusion_documents()
        document["walks"] = [row.to_dict() for row in self.rows]
        document["skipped"] = [{"walk": walk.walk, "reason": walk.reason} for walk in self.skipped]
        return document

    def _confusion_documents(self) -> Json:
        by_name = {
            name: {of: confusion.to_dict() for of, confusion in self.confusions(name).items()} for name in self.names
        }
        if not any(by_name.values()):
            return {}
        documents: Json = {"confusion": by_name[self.settings[self.axis]]}
        if len(self.names) > 1:
            documents[f"{self.axis}_confusion"] = by_name
        return documents

    def _rows_of(self, name: str) -> list[WalkRow]:
        return [row for row in self.rows if row.settings[self.axis] == name]

    def _averages(self, rows: Iterable[WalkRow]) -> Summary:
        chosen: Sequence[WalkRow] = list(rows)
        return {metric: Average.of(row.metrics[metric] for row in chosen) for metric in self.metrics}


def _plain(summary: Summary) -> Json:
    return {metric: average.to_dict() for metric, average in summary.items()}


def _plain_groups(groups: Mapping[str, Summary]) -> Json:
    return {name: _plain(summary) for name, summary in groups.items()}
