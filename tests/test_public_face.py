"""What a user finds under the flat names of `pdr_est`."""

import ast
import subprocess
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import pdr_est
from pdr_est import pipeline
from pdr_est.front_end.steps import StepsParams
from pdr_est.simulate import SimulatedWalk, preset, simulate_walk

NEEDED = (
    *("read", "smooth", "analyse", "detect_steps", "estimate", "build_graph", "load_config", "merge_recordings"),
    *("Parts", "Estimator", "EstimatorSpec", "WalkGraph"),
    *("Recording", "Track", "Step", "CarryingMode", "SensorBlock", "Channel", "Config", "Tracker"),
    *(
        "StepOdometry",
        "HeadingPrior",
        "PositionFix",
        "DeviceTether",
        "LoopClosure",
        "StartPose",
        "DeviceMeasurements",
    ),
    *("PdrError", "RecordingError", "ConfigError", "EstimationError", "OutputError"),
)


@pytest.fixture(scope="module")
def walk() -> SimulatedWalk:
    return simulate_walk(preset("l_shape"))


@pytest.mark.parametrize("name", NEEDED)
def test_what_a_user_needs_is_a_flat_name(name: str) -> None:
    assert name in dir(pdr_est)
    assert name in pdr_est.__all__
    assert (getattr(pdr_est, name).__doc__ or "").strip()


def test_every_public_name_exists_and_nothing_else_is_listed() -> None:
    for name in pdr_est.__all__:
        assert getattr(pdr_est, name) is not None
    assert {name for name in dir(pdr_est) if not name.startswith("__")} <= set(pdr_est.__all__)


def test_type_checkers_and_editors_see_the_names() -> None:
    tree = ast.parse(Path(pdr_est.__file__).read_text(encoding="utf-8"))
    (block,) = [node for node in tree.body if isinstance(node, ast.If)]
    seen = {
        alias.name: node.module
        for node in block.body
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("pdr_est")
        for alias in node.names
    }
    assert sorted([*seen, "__version__"]) == sorted(pdr_est.__all__)
    for name, module in seen.items():
        assert getattr(pdr_est, name) is getattr(import_module(str(module)), name)


def test_a_wrong_name_is_told() -> None:
    with pytest.raises(AttributeError, match=r"no attribute 'smoothen': its names are .*smooth"):
        _ = pdr_est.smoothen


def test_importing_the_package_loads_no_library() -> None:
    code = "import sys, pdr_est; dir(pdr_est); print({'numpy', 'gtsam', 'polars', 'matplotlib'} & set(sys.modules))"
    done = subprocess.run((sys.executable, "-c", code), capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_the_package_runs_as_a_program() -> None:
    done = subprocess.run((sys.executable, "-m", "pdr_est", "--version"), capture_output=True, text=True, check=True)
    assert done.stdout == f"pdr-est, version {pdr_est.__version__}\n"


def test_the_glossary_names_the_types() -> None:
    glossary = pdr_est.__doc__ or ""
    for name in (
        "Recording",
        "Step",
        "StepOdometry",
        "HeadingPrior",
        "PositionFix",
        "DeviceTether",
        "Track",
        "Config",
    ):
        assert f"- {name}: " in glossary


def test_the_example_of_the_glossary_runs(
    walk: SimulatedWalk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pdr_est.io.formats.plain_csv.writer import write_plain_csv

    (tmp_path / "demo-out").mkdir()
    write_plain_csv(walk.recording, tmp_path / "demo-out" / "simulated-walk.csv")
    lines = [line[4:] for line in (pdr_est.__doc__ or "").splitlines() if line.startswith("    ")]
    assert len([line for line in lines if line]) == 5
    monkeypatch.chdir(tmp_path)
    exec("\n".join(lines), {})
    assert len(pdr_est.Track.from_csv("my-track.csv")) > 10


def test_steps_in_one_line(walk: SimulatedWalk) -> None:
    phone = walk.recording.devices[0]
    assert phone.specific_force is not None
    assert phone.rotation_rate is not None
    time_s, acc_mps2 = phone.specific_force.time_s, phone.specific_force.values
    turning = phone.rotation_rate
    gyr_radps = np.column_stack([np.interp(time_s, turning.time_s, column) for column in turning.values.T])
    steps = pdr_est.detect_steps(time_s, acc_mps2, gyr_radps)
    assert abs(len(steps) - walk.step_count) <= 2
    (analysed,) = pdr_est.analyse(walk.recording)
    expected_s = [step.event.time_s for step in analysed.steps]
    np.testing.assert_allclose([step.time_s for step in steps], expected_s, atol=0.02)
    assert steps[5].mode is pdr_est.CarryingMode.HOLDING
    without = pdr_est.detect_steps(time_s, acc_mps2)
    assert abs(len(without) - walk.step_count) <= 3
    settings = replace(pdr_est.Config(), steps=StepsParams(detector="zero-crossing"))
    assert len(pdr_est.detect_steps(time_s, acc_mps2, gyr_radps, settings)) > 10


def test_a_track_from_odometry_is_that_of_the_pipeline(walk: SimulatedWalk) -> None:
    (analysed,) = pdr_est.analyse(walk.recording)
    fixes = [pdr_est.PositionFix(2.0, np.zeros(2), np.eye(2)), pdr_est.PositionFix(20.0, np.ones(2), np.eye(2))]
    ours = pdr_est.estimate(analysed.whole_walk_odometry, fixes)
    track = pdr_est.smooth(walk.recording, fixes=fixes)
    # The pipeline starts the walk at its first sample, and this at the first step.
    np.testing.assert_allclose(ours.position_m[1:], track.position_m[1:], atol=1e-6)
    start = pdr_est.StartPose(position_m=(3.0, 4.0), heading_rad=np.pi / 2)
    reckoned = pdr_est.estimate(analysed.odometry, estimator="dead-reckoning", start=start)
    np.testing.assert_allclose(reckoned.position_m[0], [3.0, 4.0])
    assert reckoned.estimator == "dead-reckoning"


def steps_of(device: str, turn_rad: float, n: int = 40) -> list[pdr_est.StepOdometry]:
    covariance = np.diag([0.1, 0.13, 0.05]) ** 2
    return [pdr_est.StepOdometry(device, 0.5 * k + 0.5, 0.5 * k, 0.7, turn_rad, covariance) for k in range(n)]


STEPS = steps_of("a", 0.0, 3)


def test_two_devices_and_the_person_from_odometry() -> None:
    left, right = steps_of("left", 0.01), steps_of("right", -0.01)
    mixed = [one for pair in zip(left, right, strict=True) for one in pair]
    tethers = [pdr_est.DeviceTether("left", "right", float(time_s), 0.5, 0.02) for time_s in range(1, 21)]
    start = pdr_est.StartPose((0.0, 0.0), 0.0, 0.1, 0.02)
    track = pdr_est.estimate(mixed, start=start, tethers=tethers)
    assert track.devices == ("left", "right", "fused")
    ends_m = [track.of_device(name).position_m[-1] for name in ("left", "right")]
    assert np.linalg.norm(ends_m[0] - ends_m[1]) < 0.6
    devices = [
        pdr_est.DeviceMeasurements(name, 0.0, tuple(steps)) for name, steps in (("left", left), ("right", right))
    ]
    again = pdr_est.estimate(devices, start=start, tethers=tethers)
    np.testing.assert_array_equal(again.position_m, track.position_m)


def test_what_does_not_fit_in_odometry_of_the_user_is_found() -> None:
    covariance = np.diag([0.05, 0.05, 0.02]) ** 2
    odometry = [pdr_est.StepOdometry("phone", 0.5 * k + 0.5, 0.5 * k, 0.7, 0.0, covariance) for k in range(40)]
    wrong = pdr_est.PositionFix(20.0, np.array([0.0, 28.0]), np.eye(2))
    start = pdr_est.StartPose((0.0, 0.0), 0.0, 0.1, 0.05)
    (finding,) = pdr_est.estimate(odometry, [wrong], "ekf", start=start).findings
    assert isinstance(finding, pdr_est.Finding)
    assert finding.kind is pdr_est.FindingKind.FIXES
    assert pdr_est.estimate(odometry, [], "ekf", start=start).findings == ()
    unknown = pdr_est.estimate(odometry, start=pdr_est.StartPose((0.0, 0.0)))
    assert [one.kind for one in unknown.findings] == [pdr_est.FindingKind.START_HEADING]


@pytest.mark.parametrize(
    ("odometry", "words"),
    [
        ([], "odometry holds nothing: give a sequence of StepOdometry"),
        (
            [*STEPS, pdr_est.PositionFix(1.0, np.zeros(2), np.eye(2))],
            "position fixes go into `fixes`",
        ),
        (
            [*STEPS, pdr_est.DeviceMeasurements("b", 0.0, ())],
            "holds DeviceMeasurements, StepOdometry",
        ),
        ([pdr_est.HeadingPrior("a", 1.0, 0.0, 0.1)], "a: no StepOdometry among its measurements"),
    ],
)
def test_odometry_that_gives_no_track_is_refused(odometry: list[pdr_est.StepOdometry], words: str) -> None:
    with pytest.raises(pdr_est.EstimationError, match=words):
        pdr_est.estimate(odometry)


def test_the_flat_functions_are_the_pipeline_with_defaults(walk: SimulatedWalk) -> None:
    whole = pipeline.smooth_recording(walk.recording, pdr_est.Config())
    np.testing.assert_array_equal(pdr_est.smooth(walk.recording).position_m, whole.track.position_m)
    assert repr(pdr_est.analyse(walk.recording)[0]) == repr(whole.devices[0])
    assert repr(whole.devices[0]).startswith(f"DeviceWalk('device': {len(whole.devices[0].steps)} steps, ")


class StandsStill:
    """Estimator from outside the package: the walker never leaves the start."""

    spec = pdr_est.EstimatorSpec("stands-still", uses_fixes=False)

    def estimate(self, devices, tethers, start, sigma_length_scale):
        track = pdr_est.estimate(devices, estimator="dead-reckoning", start=start, tethers=tethers)
        return replace(track, position_m=np.zeros_like(track.position_m), estimator="stands-still")


def test_parts_of_the_user_reach_the_flat_functions(walk: SimulatedWalk) -> None:
    track = pdr_est.smooth(walk.recording, parts=pdr_est.Parts(estimator=StandsStill()))
    assert track.estimator == "stands-still"
    assert not track.position_m.any()
    again = pdr_est.estimate(steps_of("phone", 0.0), estimator=StandsStill())
    assert again.estimator == "stands-still"
    (analysed,) = pdr_est.analyse(walk.recording, parts=pdr_est.Parts(heading=AlwaysEast))
    assert {step.heading_rad for step in analysed.steps} == {0.0}


class AlwaysEast:
    """Heading stage from outside the package."""

    latency_s = 0.0

    def push(self, item: pdr_est.Step) -> list[pdr_est.Step]:
        return [replace(item, heading_rad=0.0)]

    def flush(self) -> list[pdr_est.Step]:
        return []


def test_an_unknown_estimator_is_refused() -> None:
    with pytest.raises(pdr_est.EstimationError, match="unknown estimator 'kalman': choose one of auto, dead"):
        pdr_est.estimate(steps_of("phone", 0.0), estimator="kalman")
    with pytest.raises(pdr_est.ConfigError, match="has no estimate, spec"):
        pdr_est.estimate(steps_of("phone", 0.0), estimator=lambda: 3)


def test_a_path_is_no_recording_and_no_settings(walk: SimulatedWalk) -> None:
    for function in (pdr_est.smooth, pdr_est.analyse):
        with pytest.raises(pdr_est.RecordingError, match="is no recording: read it first"):
            function("walk.csv")
    with pytest.raises(pdr_est.ConfigError, match="is no configuration: load it with load_config"):
        pdr_est.smooth(walk.recording, "settings.yaml")


def test_recordings_of_two_phones_become_one() -> None:
    time_s, force = np.arange(200) / 100.0, np.tile([0.0, 0.0, 9.81], (200, 1))
    both = pdr_est.merge_recordings(
        [
            pdr_est.Recording.from_arrays(time_s, force * s, device=name, name=name)
            for name, s in (("a", 1), ("b", 1.01))
        ]
    )
    assert [device.name for device in both.devices] == ["a", "b"]


def test_the_graph_of_a_walk_is_a_flat_name() -> None:
    built = pdr_est.build_graph(steps_of("phone", 0.0))
    assert isinstance(built, pdr_est.WalkGraph)
    assert built.graph.size() >= 40
