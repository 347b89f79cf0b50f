"""The stage that tells walking, jogging and running."""

from dataclasses import replace

from pdr_est.front_end.gait.features import begins_walk, step_features
from pdr_est.front_end.gait.inference import GaitScorer, gait_of
from pdr_est.front_end.gait.model import GaitModel
from pdr_est.records import Step


class GaitClassifier:
    """Stage Step -> Step that fills in the gait and the probability of each.

    The scores of a step are averaged with those of the step before, except at the beginning of a walk. So a step is
    emitted at once, and a change of gait is seen at its second step at the latest when both steps are clear.
    """

    latency_s = 0.0

    def __init__(self, model: GaitModel) -> None:
        self._features = step_features(model.features)
        self._scorer = GaitScorer(model)
        self._previous: Step | None = None
        self._scores = (0.0, 0.0)  # of the previous step

    def push(self, item: Step, /) -> list[Step]:
        scores = self._scorer.scores(self._features.push(item))
        if begins_walk(item, self._previous):
            pooled = scores
        else:
            pooled = 0.5 * (scores[0] + self._scores[0]), 0.5 * (scores[1] + self._scores[1])
        self._previous, self._scores = item, scores
        probabilities = self._scorer.probabilities(pooled)
        return [replace(item, gait=gait_of(probabilities), gait_probability=probabilities)]

    def flush(self) -> list[Step]:
        return []


class UnknownGait:
    """Stage Step -> Step that leaves the gait unknown."""

    latency_s = 0.0

    def push(self, item: Step, /) -> list[Step]:
        return [item]

    def flush(self) -> list[Step]:
        return []
