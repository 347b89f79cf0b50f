"""Walks without steps, of one step, of steps that lead nowhere, and very long ones."""

import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import gtsam
import numpy as np
import pytest
from estimator_walks import STEP_S, fix, run, simulate, step, straight, usual_covariance, winding

from pdr_est.errors import EstimationError
from pdr_est.estimators import ESTIMATORS, SPECS, EstimatorName, estimate_track
from pdr_est.estimators.factor_graph.smoother import LARGE_STACK_POSES
from pdr_est.types.measurements import Measurement, StartPose, StepOdometry
from pdr_est.types.track import Track

every_estimator = pytest.mark.parametrize("name", ESTIMATORS)
every_start = pytest.mark.parametrize(
    "start",
    [StartPose(), StartPose((1.0, 2.0)), StartPose(None, 0.5), StartPose((1.0, 2.0), 0.5, 0.1, 0.1)],
    ids=["nothing", "position", "heading", "both"],
)


def check_sound(track: Track, poses: int) -> None:
    assert len(track) == poses
    for values in (track.position_m, track.heading_rad, track.covariance_m2, track.sigma_heading_rad):
        assert np.all(np.isfinite(values))
    assert np.all(np.linalg.eigvalsh(track.covariance_m2) >= -1e-9)
    assert np.all(np.diff(track.time_s) >= 0.0)


@every_estimator
@every_start
@pytest.mark.parametrize("fixes", [[], [fix(0, 5, 5)], [fix(0, 5, 5), fix(0, 5, 5), fix(9, 6, 5)]], ids=len)
@pytest.mark.parametrize("steps", [[], straight(1)], ids=["no step", "one step"])
def test_next_to_no_walk(
    name: EstimatorName, start: StartPose, fixes: list[Measurement], steps: list[Measurement]
) -> None:
    check_sound(run(name, [*steps, *fixes], start), len(steps) + 1)


@every_estimator
def test_no_step_and_fixes_is_their_mean(name: EstimatorName) -> None:
    track = run(name, [fix(0, 4.5, 5.0, 0.4), fix(1, 5.5, 5.0, 0.4)], StartPose(heading_rad=1.0))
    sampled = SPECS[name].sampled
    assert track.position_m[0] == pytest.approx([5.0, 5.0], abs=0.1 if sampled else 1e-3)
    off = 0.03 if sampled else 1e-6
    assert track.covariance_m2[0] == pytest.approx(0.08 * np.eye(2), rel=1e-3, abs=off)


def around_a_gap(gap_m: float, sigma_turn_rad: float) -> list[Measurement]:
    """Ten steps, a gap with this reach, and forty steps more."""
    bridge = step(11, 0.0, covariance=np.diag([gap_m, gap_m, sigma_turn_rad]) ** 2, observed=False)
    return [*straight(10), bridge, *(step(k) for k in range(12, 52))]


@pytest.mark.parametrize("gap_m", [600.0, 3600.0, 86400.0])
def test_a_gap_of_hours_in_the_graph_is_as_in_the_filter(gap_m: float) -> None:
    """The square of a walker's reach in a gap is further from that of a step's noise than Cholesky can bear."""
    walk = around_a_gap(gap_m, sigma_turn_rad=1.8)
    graph, filtered = (run(name, walk, StartPose()) for name in ("factor-graph", "ekf"))
    check_sound(graph, 52)
    assert graph.position_m == pytest.approx(filtered.position_m, abs=1e-6)
    assert graph.covariance_m2 == pytest.approx(filtered.covariance_m2, rel=1e-5, abs=1e-5)


@pytest.mark.parametrize("gap_m", [600.0, 3600.0, 86400.0])
def test_fixes_behind_a_gap_of_hours(gap_m: float) -> None:
    fixes = [fix(k, 0.7 * k, 4e-5 * gap_m) for k in range(15, 50, 5)]
    walk = [*around_a_gap(gap_m, sigma_turn_rad=0.02), *fixes]
    graph, filtered = (run(name, walk, StartPose((0.0, 0.0), 0.0, 0.1, 0.02)) for name in ("factor-graph", "ekf"))
    check_sound(graph, 52)
    # The filter's last pose has seen what every pose of the graph has.
    assert graph.position_m[-1] == pytest.approx(filtered.position_m[-1], abs=0.05)
    assert graph.covariance_m2[-1] == pytest.approx(filtered.covariance_m2[-1], rel=0.05, abs=0.01)


@every_estimator
@every_start
def test_steps_of_no_length(name: EstimatorName, start: StartPose) -> None:
    nowhere = [step(k, 0.0, covariance=usual_covariance(0.0)) for k in range(1, 11)]
    track = run(name, [*nowhere, fix(0, 5, 5), fix(5.5, 5, 6), fix(10, 5, 5)], start)
    check_sound(track, 11)


@every_estimator
@every_start
def test_steps_without_noise(name: EstimatorName, start: StartPose) -> None:
    exact = straight(10, covariance=np.zeros((3, 3)))
    check_sound(run(name, [*exact, fix(0, 5, 5), fix(4.5, 8, 5), fix(10, 12, 5)], start, 0.0), 11)


@every_estimator
@every_start
def test_steps_at_the_same_time(name: EstimatorName, start: StartPose) -> None:
    twins = [replace(step(k), time_s=STEP_S * (k // 2), start_s=STEP_S * (k // 2)) for k in range(1, 21)]
    check_sound(run(name, [*twins, *(fix(k, 0.7 * k, 0) for k in range(0, 11, 2))], start), 21)


@every_estimator
def test_a_gap_after_which_nothing_is_known(name: EstimatorName) -> None:
    rng = np.random.default_rng(1)
    walk = simulate(rng, winding(60, rng), (50.0, 50.0, 1.0), fix_every=10)
    bridge = StepOdometry("phone", 40.25, 30.0, 0.0, 0.0, np.diag([900.0, 900.0, 3.3]), observed=False)
    later = [
        replace(one, time_s=one.time_s + 10.5, start_s=one.start_s + 10.5) if one.time_s > 30.0 else one
        for one in [*walk.odometry, *straight(80)[60:]]
    ]
    measurements = [*later[:60], bridge, *later[60:], *walk.fixes]
    check_sound(run(name, measurements, StartPose()), 82)


@every_estimator
def test_maps_far_from_their_origin(name: EstimatorName) -> None:
    rng = np.random.default_rng(2)
    walk = simulate(rng, winding(60, rng), (500_000.0, 5_400_000.0, 1.0), fix_every=15)
    track = run(name, walk.measurements, StartPose())
    check_sound(track, 61)
    assert np.max(np.abs(track.position_m - walk.truth[:, :2])) < 10.0


def test_an_unknown_estimator_is_named() -> None:
    expected = r"unknown estimator 'kalman': choose one of auto, dead-reckoning, map-"
    with pytest.raises(EstimationError, match=expected):
        estimate_track("kalman", "phone", 0.0, [], StartPose(), 0.1)  # type: ignore[arg-type]


@pytest.mark.parametrize("steps", [10, LARGE_STACK_POSES + 1], ids=["short", "long"])
def test_a_graph_that_cannot_be_solved_is_an_estimation_error(steps: int, monkeypatch: pytest.MonkeyPatch) -> None:
    def indeterminate(*_: object) -> None:
        raise RuntimeError("\nIndeterminate linear system detected\nwhile working near variable 7")

    monkeypatch.setattr(gtsam.GaussianFactorGraph, "eliminateSequential", indeterminate)
    with pytest.raises(EstimationError, match=r"\(Indeterminate linear system detected\): give a start pose"):
        run("factor-graph", [*straight(steps), fix(1.0, 1.0, 0.0)], StartPose())


LONG_WALK = """
import sys
import numpy as np
from estimator_walks import fix, run, step
from pdr_est.types.measurements import StartPose
count = int(sys.argv[1])
turns = 0.1 * np.sin(np.arange(count) / 50.0)
walk = [step(k, 0.7, float(turn)) for k, turn in enumerate(turns, 1)]
truth = run("dead-reckoning", walk, StartPose((0.0, 0.0), 0.0), 0.0)
fixes = [fix(k + 0.5, *truth.position_m[k]) for k in range(0, count, 200)]
track = run("factor-graph", [*walk, *fixes], StartPose())
print(np.max(np.abs(track.position_m - truth.position_m)))
"""


def largest_error_with_an_8_mb_stack(count: int) -> float:
    done = subprocess.run(
        ["sh", "-c", 'ulimit -s 8192; exec "$@"', "sh", sys.executable, "-c", LONG_WALK, str(count)],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[1] / "support",
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return float(done.stdout)


@pytest.mark.slow
def test_walks_around_the_size_where_the_stack_is_enlarged() -> None:
    assert largest_error_with_an_8_mb_stack(LARGE_STACK_POSES - 100) < 3.0


@pytest.mark.slow
def test_fifty_thousand_steps_fit_an_8_mb_stack() -> None:
    assert largest_error_with_an_8_mb_stack(50_000) < 3.0


@pytest.mark.slow
@every_estimator
@pytest.mark.parametrize("start", [StartPose((0.0, 0.0), 0.0, 0.1, 0.1), StartPose()], ids=["known", "unknown"])
def test_time_grows_with_the_number_of_steps(name: EstimatorName, start: StartPose) -> None:
    def seconds(count: int) -> float:
        walk = simulate(np.random.default_rng(3), winding(count, np.random.default_rng(4)), fix_every=50)
        begin = time.process_time()
        check_sound(run(name, walk.measurements, start), count + 1)
        return time.process_time() - begin

    assert seconds(50_000) < 8.0 * seconds(12_500)
