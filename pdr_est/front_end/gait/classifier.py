"""The stages that fill in the gait of each step."""

from collections.abc import Sequence

import numpy as np

from pdr_est.front_end.gait.features import step_features
from pdr_est.front_end.gait.model import GaitModel
from pdr_est.front_end.gait.svm_scorer import GaitScorer, decide_gait, gait_changes
from pdr_est.records import changed_each
from pdr_est.types.steps import Step, walks_begun

_AT_ONCE = 1024  # steps whose samples are looked at together, which bounds the memory


class GaitClassifier:
    """Stage Step -> Step that fills in the gait and the probability of each gait.

    The scores of a step are averaged with those of the step before, except at the beginning of a walk and where a
    step clearly contradicts the one before (`gait_changes`). So a step is emitted at once. A stride that joins two
    gaits has the score of neither, so most changes between walking and faster gaits are seen at their second step,
    and about one in a hundred later: experiments/gait_changes.py measures it.

    Parameters
    ----------
    model : GaitModel
        Trained classifier.

    References
    ----------
    UPTIME: Alzantot and Youssef, WCNC 2012, section III-B and Figure 5, for the two levels of the classifier.
    Averaging over steps is ours.
    """

    latency_s = 0.0

    def __init__(self, model: GaitModel) -> None:
        self._features = step_features(model.features)
        self._scorer = GaitScorer(model)
        self._previous: Step | None = None
        self._scores = np.zeros((2, 1))  # of the previous step

    def push(self, item: Step, /) -> list[Step]:
        """Classify a step."""
        return self.push_all([item])

    def push_all(self, items: Sequence[Step], /) -> list[Step]:
        """Classify steps."""
        found: list[Step] = []
        for begin in range(0, len(items), _AT_ONCE):
            found += self._classified(items[begin : begin + _AT_ONCE])
        return found

    def _classified(self, steps: Sequence[Step]) -> list[Step]:
        """Average the scores of each step with those of the step before, and decide."""
        scores = self._scorer.scores(self._features.push_all(steps))
        before = np.concatenate([self._scores, scores[:, :-1]], axis=1)
        alone = np.array(walks_begun(steps, self._previous)) | gait_changes(scores[0], before[0])
        self._previous, self._scores = steps[-1], scores[:, -1:]
        pooled = np.where(alone, scores, 0.5 * (scores + before))
        probabilities = list(map(tuple, self._scorer.probabilities(pooled).tolist()))
        return changed_each(steps, gait=map(decide_gait, probabilities), gait_probability=probabilities)

    def flush(self) -> list[Step]:
        """Return nothing: no step is held back."""
        return []


class UnknownGait:
    """Stage Step -> Step that leaves the gait unknown."""

    latency_s = 0.0

    def push(self, item: Step, /) -> list[Step]:
        """Return the step as it is."""
        return [item]

    def flush(self) -> list[Step]:
        """Return nothing: no step is held back."""
        return []
