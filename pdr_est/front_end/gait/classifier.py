"""The stages that fill in the gait of each step."""

from collections.abc import Sequence

from pdr_est.front_end.gait.features import step_features
from pdr_est.front_end.gait.model import GaitModel
from pdr_est.front_end.gait.svm_scorer import GaitScorer, decide_gait, is_gait_change
from pdr_est.records import changed
from pdr_est.types.steps import Step, begins_walk

_AT_ONCE = 1024  # steps whose samples are looked at together, which bounds the memory


class GaitClassifier:
    """Stage Step -> Step that fills in the gait and the probability of each gait.

    The scores of a step are averaged with those of the step before, except at the beginning of a walk and where a
    step clearly contradicts the one before (`is_gait_change`). So a step is emitted at once. A stride that joins two
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
        self._scores = (0.0, 0.0)  # of the previous step

    def push(self, item: Step, /) -> list[Step]:
        """Classify a step."""
        return self.push_all([item])

    def push_all(self, items: Sequence[Step], /) -> list[Step]:
        """Classify steps."""
        found: list[Step] = []
        for begin in range(0, len(items), _AT_ONCE):
            steps = items[begin : begin + _AT_ONCE]
            scores = self._scorer.scores(self._features.push_all(steps))
            found += [self._classified(step, *pair) for step, pair in zip(steps, scores, strict=True)]
        return found

    def _classified(self, step: Step, faster: float, running: float) -> Step:
        """Average the scores of a step with those of the step before, and decide."""
        scores = pooled = faster, running
        if not (begins_walk(step, self._previous) or is_gait_change(faster, self._scores[0])):
            pooled = 0.5 * (faster + self._scores[0]), 0.5 * (running + self._scores[1])
        self._previous, self._scores = step, scores
        probabilities = self._scorer.probabilities(pooled)
        return changed(step, gait=decide_gait(probabilities), gait_probability=probabilities)

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
