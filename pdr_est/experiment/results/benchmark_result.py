"""Result of a benchmark: rows of all tracks, and the averages over them."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from pdr_est import __version__
from pdr_est.evaluate.metric_definitions import DEFINITIONS, pooled_average
from pdr_est.evaluate.statistics import Average
from pdr_est.experiment.results.walk_result import Failure
from pdr_est.experiment.scoring.known_plan import PLAN_METRICS
from pdr_est.experiment.suite import ConfusionMatrix, Suite, WalkFile
from pdr_est.experiment.variants.alignment import aligned_variants
from pdr_est.experiment.variants.axes import Comparison
from pdr_est.types.outcome import TrackOutcome

Json = dict[str, Any]
Summary = dict[str, Average]


@dataclass(frozen=True)
class BenchmarkResult:
    """Scores of a suite with the variants of a comparison.

    Attributes
    ----------
    suite : Suite
        The suite that was run.
    comparison : Comparison
        The variants that were run.
    files : Mapping
        Walk -> its file, with its labels and its group.
    rows : tuple of TrackOutcome
        One row for each walk, variant and track.
    failures : tuple of Failure
        Walks and metrics that could not be scored.
    seconds : Mapping
        (walk, variant) -> CPU time of the chain.
    turn_device : str or None
        Turn of the device axes of all recordings.
    """

    suite: Suite
    comparison: Comparison
    files: Mapping[str, WalkFile]
    rows: tuple[TrackOutcome, ...]
    failures: tuple[Failure, ...]
    seconds: Mapping[tuple[str, str], float]
    turn_device: str | None = None

    @property
    def aligned(self) -> tuple[str, ...]:
        """Variants whose estimator only aligns its track with the fixes; none if no metric is one with fixes."""
        with_fixes = any(name in DEFINITIONS and DEFINITIONS[name].with_fixes for name in self.suite.metrics)
        return aligned_variants(self.comparison.variants) if with_fixes else ()

    @property
    def estimator_on_plan(self) -> str | None:
        """Estimator of the metrics on a floor plan where that of all others was not chosen; None for the same one."""
        if not set(PLAN_METRICS) & set(self.suite.metrics):
            return None
        names = (variant.automatic_on_plan for variant in self.comparison.variants)
        return next((name for name in names if name is not None), None)

    def summary(self, variant: str) -> Summary:
        """Average each metric of a variant over the headline walks."""
        return self._averages(row for row in self._rows_of(variant) if self.files[row.walk].headline)

    def groups(self, variant: str) -> dict[str, Summary]:
        """Average each metric of a variant over each group of walks; empty if the suite has no groups."""
        rows: dict[str, list[TrackOutcome]] = {}
        for row in self._rows_of(variant):
            group = self.files[row.walk].group
            if group is not None:
                rows.setdefault(group, []).append(row)
        return {group: self._averages(rows[group]) for group in sorted(rows)}

    def confusions(self, variant: str) -> Mapping[str, ConfusionMatrix]:
        """Return the confusion matrices of a variant, by name; empty if the suite does not classify steps."""
        return self.suite.confusions(self._rows_of(variant))

    def to_dict(self) -> Json:
        """Make the JSON document.

        With several variants the value of the compared setting is "all", `summary` and `groups` are those of the
        configured variant, and (for the setting "estimator") `estimators` and `estimator_groups` contain those of
        each. A suite that classifies steps also has `confusion` and `estimator_confusion`. `aligned_with_fixes` lists
        the variants, if any, whose metrics with fixes are those of a track that was only aligned with them.
        `estimator_on_plan` names the estimator of the metrics on a floor plan where none was chosen.
        """
        main, axis, names = self.comparison.main, self.comparison.axis, self.comparison.names
        document: Json = {
            "suite": self.suite.name,
            "version": __version__,
            **main.settings(),
            **({} if self.turn_device is None else {"turn-device": self.turn_device}),
            "summary": _plain(self.summary(main.name)),
            "groups": _plain_groups(self.groups(main.name)),
        }
        confusions = {name: _plain_confusions(self.confusions(name)) for name in names}
        if len(names) > 1:
            document[axis] = "all"
            document[f"{axis}s"] = {name: _plain(self.summary(name)) for name in names}
            document[f"{axis}_groups"] = {name: _plain_groups(self.groups(name)) for name in names}
        if any(confusions.values()):
            document["confusion"] = confusions[main.name]
            if len(names) > 1:
                document[f"{axis}_confusion"] = confusions
        if self.estimator_on_plan is not None:
            document["estimator_on_plan"] = self.estimator_on_plan
        if self.aligned:
            document["aligned_with_fixes"] = list(self.aligned)
        document["walks"] = self._row_documents()
        document["skipped"] = [{"walk": failure.walk, "reason": failure.reason} for failure in self.failures]
        return document

    def _row_documents(self) -> list[Json]:
        settings = {variant.name: variant.settings() for variant in self.comparison.variants}
        return [
            {
                "walk": row.walk,
                "track": row.track,
                **settings[row.variant],
                "mode": row.mode,
                **self.files[row.walk].labels,
                **row.metrics,
                **row.counts,
                "findings": row.findings,
                **({"predicted": dict(row.predicted)} if row.predicted else {}),
                "seconds": self.seconds[row.walk, row.variant],
            }
            for row in self.rows
        ]

    def _rows_of(self, variant: str) -> list[TrackOutcome]:
        return [row for row in self.rows if row.variant == variant]

    def _averages(self, rows: Iterable[TrackOutcome]) -> Summary:
        chosen = list(rows)
        return {
            metric: pooled_average(metric, ((row.metrics[metric], row.counts) for row in chosen))
            for metric in self.suite.metrics
        }


def _plain(summary: Summary) -> Json:
    return {metric: asdict(average) for metric, average in summary.items()}


def _plain_groups(groups: Mapping[str, Summary]) -> Json:
    return {name: _plain(summary) for name, summary in groups.items()}


def _plain_confusions(confusions: Mapping[str, ConfusionMatrix]) -> Json:
    return {
        name: {"counts": {true: dict(labels) for true, labels in one.counts.items()}, **one.shares}
        for name, one in confusions.items()
    }
