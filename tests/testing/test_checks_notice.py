"""The checks of `pdr_est.testing` notice what is wrong with a stage or an estimator."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pdr_est.estimators import EstimatorSpec, OnlinePose, estimator_named
from pdr_est.front_end.steps import StepsParams, step_detector
from pdr_est.testing import check_estimator, check_partition, check_stage, stage_inputs
from pdr_est.types.region import PoseRegion
from pdr_est.types.track import Track


class Detector:
    """A stage that is right: the default detector."""

    latency_s = 3.0

    def __init__(self) -> None:
        self.own = step_detector(50.0, StepsParams())
        self.latency_s = self.own.latency_s

    def push(self, item: Any) -> Any:
        return self.own.push(item)

    def flush(self) -> Any:
        return self.own.flush()


SEEN: list[Any] = []


class Sharing(Detector):
    def push(self, item: Any) -> Any:
        SEEN.append(item)
        return self.own.push(item) if len(SEEN) % 7 else []


class Changing(Detector):
    def push(self, item: Any) -> Any:
        item.vertical_mps2.flags.writeable = True
        item.vertical_mps2[:] += 0.01
        return self.own.push(item)


class Lazy(Detector):
    def push(self, item: Any) -> Any:
        return iter(self.own.push(item))


class Late(Detector):
    def __init__(self) -> None:
        super().__init__()
        self.latency_s = 0.01


class Unpicklable(Detector):
    def __init__(self) -> None:
        super().__init__()
        self.function = lambda: None


class Counting(Detector):
    """Looks at the number of blocks."""

    def __init__(self) -> None:
        super().__init__()
        self.count = 0

    def push(self, item: Any) -> Any:
        self.count += 1
        return [replace(event, confidence=1.0 / self.count) for event in self.own.push(item)]


class NoFlush:
    latency_s = 0.0
    push = print


class Silent(Detector):
    def push(self, item: Any) -> Any:
        return []

    def flush(self) -> Any:
        return []


@pytest.mark.parametrize(
    ("stage", "message"),
    [
        (NoFlush, r"NoFlush has no flush"),
        (Silent, r"Silent emits nothing for these inputs"),
        (Lazy, r"Lazy.push returns list_iterator: it must return a list"),
        (Changing, r"Changing changes its inputs"),
        (Sharing, r"two stages Sharing in turns share state"),
        (Counting, r"Counting with empty blocks"),
        (Late, r"Late: the output of .* s comes .* s later, more than latency_s = 0.010"),
        (Unpicklable, r"Unpicklable cannot be pickled"),
    ],
)
def test_a_wrong_stage_is_noticed(stage: Callable[[], Any], message: str) -> None:
    SEEN.clear()
    check_stage(Detector, stage_inputs("level"))
    inputs = stage_inputs("level") if stage is not Changing else stage_inputs("level", seed=2)
    with pytest.raises(AssertionError, match=message):
        check_stage(stage, inputs)


def test_one_stage_for_all_is_noticed() -> None:
    stage = Detector()
    with pytest.raises(AssertionError, match=r"the factory of Detector gives one stage twice"):
        check_stage(lambda: stage, stage_inputs("level", seed=3))


def test_what_depends_on_the_cut_is_noticed() -> None:
    check_partition(Detector, stage_inputs("level"))
    with pytest.raises(AssertionError, match=r"Counting, cut 1 of 4 into \d+ pieces: output \d+ of \d+ differs"):
        check_partition(Counting, stage_inputs("level"))


class Estimator:
    """An estimator that is right: the EKF, as one for whole walks."""

    spec = EstimatorSpec("mine", uses_closure=True, uses_tethers=True)

    def __init__(self, **changes: Any) -> None:
        self.spec = replace(self.spec, **changes)
        self.calls = 0

    def estimate(self, devices: Any, tethers: Any, start: Any, sigma_length_scale: float) -> Any:
        self.calls += 1
        track = estimator_named("ekf").estimate(devices, tethers, start, sigma_length_scale)
        return self.changed(replace(track, estimator=self.spec.name))

    def changed(self, track: Track) -> Any:
        return track


def changing(change: Callable[[Track], Any], **changes: Any) -> Estimator:
    made = Estimator(**changes)
    made.changed = change  # type: ignore[method-assign]
    return made


def region_of(track: Track, weight: float, scale: float) -> PoseRegion:
    """Regions of one component with this weight and the covariances of the track times a factor."""
    region = PoseRegion.of_gaussians(track.position_m, scale * track.covariance_m2)
    return replace(region, weight=weight * region.weight)


class Remembering(Estimator):
    def changed(self, track: Track) -> Track:
        return replace(track, step_length_m=track.step_length_m + self.calls)


class Online(Estimator):
    """Has a filter that says nothing."""

    def begin(self, *_: Any) -> Any:
        return self

    def push(self, _: Any) -> list[OnlinePose]:
        return []

    def flush(self) -> list[OnlinePose]:
        return []


@pytest.mark.parametrize(
    ("estimator", "message"),
    [
        (object(), r"object has no spec"),
        (changing(lambda track: None), r"estimator mine returns NoneType: it must return a Track"),
        (changing(lambda track: track.rows_where(track.time_s > 1.0)), r"\d+ poses for the start and 40 steps"),
        (changing(lambda track: replace(track, kind="smoothed")), r"the track is 'smoothed', by the spec it must be"),
        (Estimator(smooths=True), r"the track is 'filtered', by the spec it must be smoothed"),
        (changing(lambda track: replace(track, estimator="ekf")), r"the track names the estimator 'ekf'"),
        (
            changing(lambda track: replace(track, covariance_m2=-track.covariance_m2)),
            r"has the eigenvalue .*, below 0",
        ),
        (changing(lambda track: replace(track, covariance_m2=0.0 * track.covariance_m2)), r"does not grow"),
        (changing(lambda track: replace(track, region=region_of(track, 0.5, 1.0))), r"do not add up to 1"),
        (
            changing(lambda track: replace(track, region=region_of(track, 1.0, -1.0))),
            r"of a region has the eigenvalue",
        ),
        (
            changing(lambda track: replace(track, region=region_of(track, 1.0, 1.0).rows(slice(3)))),
            r"has 3 poses, the",
        ),
        (changing(lambda track: replace(track, position_m=track.position_m + 1.0)), r"the track is 1.4\d* m off"),
        (changing(lambda track: replace(track, heading_rad=np.full(len(track), np.nan))), r"heading_rad has values"),
        (Remembering(), r"the same measurements give another track the second time"),
        (Estimator(uses_fixes=False), r"uses no fixes by its spec, but a fix moves the end of a walk"),
        (Estimator(online=True), r"is online by its spec, but has no begin"),
        (Online(online=True), r"the filter gives no pose for the step that ends at \[0.5\] s"),
    ],
)
def test_a_wrong_estimator_is_noticed(estimator: Any, message: str) -> None:
    with pytest.raises(AssertionError, match=message):
        check_estimator(estimator)


@pytest.mark.parametrize(
    ("flag", "message"),
    [
        ("uses_closure", r"uses loop closures by its spec, but the closed walk ends"),
        ("uses_tethers", r"uses tethers by its spec, but devices tethered to 0.5 m end"),
    ],
)
def test_abilities_that_an_estimator_has_not_are_noticed(flag: str, message: str) -> None:
    reckoned = estimator_named("dead-reckoning")

    class Reckoned(Estimator):
        def estimate(self, *arguments: Any) -> Track:
            return replace(reckoned.estimate(*arguments), estimator="mine")

    check_estimator(Reckoned(uses_fixes=False, uses_closure=False, uses_tethers=False))
    only = {"uses_closure": False, "uses_tethers": False, flag: True}
    with pytest.raises(AssertionError, match=message):
        check_estimator(Reckoned(uses_fixes=False, **only))


def test_a_right_estimator_passes() -> None:
    check_estimator(Estimator())
