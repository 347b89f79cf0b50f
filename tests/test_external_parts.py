"""A step detector and an estimator from outside the package: offline, online, in files, in processes, in the tests.

They lie in a module of their own, in a temporary folder, as a user's would.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import polars as pl
import pytest

from pdr_est import pipeline
from pdr_est.config import Config, StartParams, config_to_yaml, external_files, import_folders, load_config
from pdr_est.errors import ConfigError, EstimationError
from pdr_est.estimators import SPECS, EstimatorSpec, estimator_named
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.online import Tracker, Update
from pdr_est.online.update import track_of
from pdr_est.parts import Parts
from pdr_est.simulate import DeviceParams, preset, simulate_walk
from pdr_est.testing import (
    check_estimator,
    check_partition,
    check_stage,
    cut_block,
    exact_content,
    in_time_order,
    stage_inputs,
)
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.sensors import SensorBlock
from pdr_est.types.steps import Gait

MODULE = '''
"""Parts of a user."""

from dataclasses import replace

import numpy as np

from pdr_est.estimators import EstimatorSpec, OnlinePose, timelines_of
from pdr_est.estimators.common.timeline import track_from_nodes
from pdr_est.params import Positive, params
from pdr_est.types.measurements import PositionFix, StepOdometry
from pdr_est.types.steps import CarryingMode, StepEvent
from pdr_est.types.track import concatenate


@params
class UpwardParams:
    """Parameters of the detector."""

    threshold_mps2: Positive = 1.0
    """Level that the vertical acceleration rises above."""

    min_interval_s: Positive = 0.3
    """Shortest time between two steps, s."""


class Upward:
    """Step detector: the vertical acceleration rises above a level."""

    latency_s = 0.0

    def __init__(self, rate_hz: float, parameters: UpwardParams = UpwardParams()) -> None:
        self.rate_hz, self.parameters = rate_hz, parameters
        self.segment, self.above, self.last_s = -1, False, -np.inf

    def push(self, item):
        found = []
        for k in range(len(item)):
            if item.segment != self.segment:
                self.segment, self.above, self.last_s = item.segment, False, -np.inf
            above, time_s = bool(item.vertical_mps2[k] > self.parameters.threshold_mps2), float(item.time_s[k])
            if above and not self.above and time_s > self.last_s + self.parameters.min_interval_s:
                self.last_s = time_s
                found.append(StepEvent(item.first_index + k, time_s, item.segment, CarryingMode(int(item.mode[k]))))
            self.above = above
        return found

    def flush(self):
        return []


def upward(rate_hz, **values):
    """Make the detector from the parameters of a configuration."""
    return Upward(rate_hz, UpwardParams(**values))


class LengthByHeight:
    """Step length: a share of the height."""

    latency_s = 0.0

    def __init__(self, walker, share=0.4):
        self.length_m = share * walker.height_m

    def push(self, item):
        return [replace(item, length_m=self.length_m, sigma_length_m=0.07)]

    def flush(self):
        return []


class Passed:
    """A gait stage, a mode stage and a heading stage that pass on what they get."""

    latency_s = 0.0

    def __init__(self):
        self.count = 0

    def push(self, item):
        self.count += 1
        return [item]

    def flush(self):
        return []


class EastNorth(Passed):
    """A heading stage: always the same direction."""

    def __init__(self, heading_rad=0.0):
        super().__init__()
        self.heading_rad = heading_rad

    def push(self, item):
        return [replace(item, heading_rad=self.heading_rad, sigma_turn_rad=0.01)]


class Walker:
    """The online filter: dead reckoning that jumps to a fix."""

    def __init__(self, devices, start, gain):
        heading = 0.0 if start.heading_rad is None else start.heading_rad
        position = (0.0, 0.0) if start.position_m is None else start.position_m
        self.gain, self.known = gain, dict.fromkeys(devices, (np.array(position), heading))
        sigmas = [start.sigma_position_m, start.sigma_position_m, start.sigma_heading_rad]
        self.covariance = dict.fromkeys(devices, np.diag(sigmas) ** 2)
        self.last = {}
        self.times_s = []

    def push(self, measurement):
        if isinstance(measurement, StepOdometry):
            self.times_s.append(measurement.time_s)
            name = measurement.device
            position, heading = self.known[name]
            heading = heading + measurement.heading_change_rad
            position = position + measurement.length_m * np.array([np.cos(heading), np.sin(heading)])
            self.known[name] = position, heading
            self.covariance[name] = self.covariance[name] + measurement.covariance
            self.last[name] = measurement.time_s
            return [self.pose(name)]
        if isinstance(measurement, PositionFix):
            self.times_s.append(measurement.time_s)
            for name, (position, heading) in self.known.items():
                self.known[name] = position + self.gain * (measurement.position_m - position), heading
                self.covariance[name] = (1.0 - self.gain) * self.covariance[name]
            return [self.pose(name) for name in self.last]
        return []

    def pose(self, name):
        position, heading = self.known[name]
        return OnlinePose(name, self.last[name], position.copy(), heading, self.covariance[name].copy())

    def flush(self):
        return []


class Jumping:
    """The estimator: that filter, offline and online."""

    spec = EstimatorSpec("jumping", online=True, uses_fixes=True)

    def __init__(self, gain=0.9):
        if not 0.0 < gain <= 1.0:
            raise ValueError(f"gain = {gain}: give a share")
        self.gain = gain

    def estimate(self, devices, tethers, start, sigma_length_scale):
        tracks = []
        for timeline in timelines_of(devices):
            own = Walker([timeline.device], start, self.gain)
            positions, headings, covariances = [], [], []
            for node in timeline.nodes:
                if positions:
                    own.push(StepOdometry(timeline.device, node.time_s, node.moving_from_s, node.length_m,
                                          node.heading_change_rad, node.covariance, node.mode))
                for fix in node.fixes:
                    own.push(fix)
                position, heading = own.known[timeline.device]
                positions.append(position)
                headings.append(heading)
                covariances.append(own.covariance[timeline.device])
            tracks.append(track_from_nodes(timeline, np.array(positions), np.array(headings), np.array(covariances),
                                           "filtered", self.spec.name, (1.0, sigma_length_scale)))
        return concatenate(tracks)

    def begin(self, devices, start, sigma_length_scale):
        return Walker(devices, start, self.gain)


class WholeWalk(Jumping):
    """The same for whole walks only."""

    spec = EstimatorSpec("whole-walk", uses_fixes=False)


NO_STAGE = object()
'''

SETTINGS = """
steps.detector: user_parts:upward
steps.parameters: {threshold_mps2: 1.2}
estimator:
  name: user_parts:Jumping
  parameters: {gain: 0.8}
start: {x_m: 0.0, y_m: 0.0, heading_rad: 0.0}
"""

EXPERIMENT = """
data:
  simulated: {presets: [l_shape], repeats: 2}
settings:
  start: {x_m: 0.0, y_m: 0.0, heading_rad: 0.0}
variants:
  ours:
    estimator.name: dead-reckoning
  theirs:
    steps: {detector: "user_parts:upward", parameters: {threshold_mps2: 1.2}}
    estimator: {name: "user_parts:Jumping"}
fixes: {protocol: every, every: 3}
metrics: [error_open_m, count_error]
"""

KNOWN_START = Config(start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("user")
    (path / "user_parts.py").write_text(MODULE, encoding="utf-8")
    (path / "settings.yaml").write_text(SETTINGS, encoding="utf-8")
    (path / "compare.yaml").write_text(EXPERIMENT, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def user(folder: Path) -> Iterator[ModuleType]:
    """The module of the user, imported as from a script beside it."""
    sys.path.append(str(folder))
    yield import_module("user_parts")
    sys.path.remove(str(folder))
    del sys.modules["user_parts"]


@pytest.fixture(scope="module")
def recording() -> Recording:
    return simulate_walk(replace(preset("l_shape"), devices=(DeviceParams(name="left"),))).recording


@pytest.fixture(scope="module")
def fixes() -> tuple[PositionFix, ...]:
    walk = simulate_walk(replace(preset("l_shape"), devices=(DeviceParams(name="left"),)))
    return walk.with_fixes(every_s=10.0, sigma_m=0.5).recording.fixes


@pytest.fixture
def parts(user: ModuleType) -> Parts:
    return Parts(step_detector=user.Upward, estimator=user.Jumping(gain=0.8))


def test_they_keep_the_contract_of_the_package(user: ModuleType) -> None:
    check_stage(lambda: user.Upward(50.0), stage_inputs("level"))
    check_partition(lambda: user.Upward(50.0), stage_inputs("level"))
    check_partition(lambda: user.LengthByHeight(Config().walker), stage_inputs("steps"))
    check_estimator(user.Jumping())
    check_estimator(estimator_named("user_parts:Jumping", {"gain": 0.95}))


@pytest.mark.parametrize("name", SPECS)
def test_so_do_the_estimators_of_the_package(name: str) -> None:
    check_estimator(estimator_named(name))


def test_offline_as_objects(parts: Parts, recording: Recording, fixes: tuple[PositionFix, ...]) -> None:
    walk = pipeline.smooth_recording(recording, KNOWN_START, fixes, parts)
    usual = pipeline.smooth_recording(recording, KNOWN_START.with_estimator("dead-reckoning"), fixes)
    assert (walk.track.estimator, walk.fixes_used, usual.fixes_used) == ("jumping", True, False)
    assert abs(len(walk.devices[0].steps) - len(usual.devices[0].steps)) <= 2
    assert [step.event for step in walk.devices[0].steps] != [step.event for step in usual.devices[0].steps]
    assert np.linalg.norm(walk.track.at(np.array([fixes[-1].time_s]))[0] - fixes[-1].position_m) < 1.5
    again = pipeline.smooth_recording(recording, KNOWN_START, fixes, parts)
    assert exact_content([again.track]) == exact_content([walk.track])


def test_every_stage_can_be_given(user: ModuleType, recording: Recording) -> None:
    seen = user.Passed()
    given = Parts(
        mode=seen,
        gait=user.Passed,
        step_length=partial(user.LengthByHeight, share=0.3),
        heading=lambda: user.EastNorth(0.5),
    )
    (walk,) = pipeline.analyse_recording(recording, Config(), given)
    assert seen.count == 0  # a stage that is given is a prototype
    assert {step.length_m for step in walk.steps} == {0.3 * Config().walker.height_m}
    assert {step.heading_rad for step in walk.steps} == {0.5}
    assert {step.gait for step in walk.steps} == {Gait.UNKNOWN}
    assert walk.directions is None
    assert {int(mode) for block in walk.level for mode in block.mode} == {0}
    named = Config().replace(
        {
            "mode.method": "user_parts:Passed",
            "gait.method": "user_parts:Passed",
            "step_length": {"model": "user_parts:LengthByHeight", "parameters": {"share": 0.3}},
            "heading": {"method": "user_parts:EastNorth", "parameters": {"heading_rad": 0.5}},
        }
    )
    (other,) = pipeline.analyse_recording(recording, named)
    assert exact_content(other.steps) == exact_content(walk.steps)


def test_each_device_has_a_stage_of_its_own(user: ModuleType) -> None:
    devices = (DeviceParams(name="left"), DeviceParams(name="right"))
    both = simulate_walk(replace(preset("l_shape"), devices=devices)).recording
    prototype = user.Upward(50.0)
    config = Config().replace({"devices.clock": "none"})  # clocks from the walk would move the samples of one
    left, right = pipeline.analyse_recording(both, config, Parts(step_detector=prototype))
    for walk, device in ((left, "left"), (right, "right")):
        alone = replace(both, devices=tuple(one for one in both.devices if one.name == device))
        (expected,) = pipeline.analyse_recording(alone, Config(), Parts(step_detector=user.Upward))
        assert [step.event.index for step in walk.steps] == [step.event.index for step in expected.steps]
    track = pipeline.smooth_recording(both, KNOWN_START, parts=Parts(estimator=user.Jumping)).track
    assert track.devices == ("left", "right", "fused")


def blocks_of(recording: Recording, cut: Callable[[list[SensorBlock]], list[Any]]) -> list[tuple[str, SensorBlock]]:
    (device,) = recording.devices
    return [(device.name, block) for block in cut(list(device.blocks()))]


@pytest.mark.parametrize("known", ["as objects", "in a file"])
def test_online_under_any_cut(
    known: str, user: ModuleType, parts: Parts, folder: Path, recording: Recording, fixes: tuple[PositionFix, ...]
) -> None:
    config, given = (
        (KNOWN_START, parts) if known == "as objects" else (load_config(folder / "settings.yaml"), Parts())
    )
    rng, updates = np.random.default_rng(3), []
    cuttings: list[Callable[[list[SensorBlock]], list[Any]]] = [list, lambda blocks: in_pieces(blocks, rng)]
    for cut in cuttings:
        tracker = Tracker(config, ["left"], parts=given)
        found: list[Update] = []
        for fix in fixes:
            found += tracker.push_fix(fix)
        for number, (name, block) in enumerate(blocks_of(recording, cut)):
            if number == 300:
                tracker = Tracker.restore(tracker.state(), given, modules=[user.__name__])
            found += tracker.push(name, block)
        updates.append(found + tracker.flush())
    tracks = [track_of(found, estimator="jumping") for found in updates]
    assert exact_content([tracks[0]]) == exact_content([tracks[1]])
    offline = pipeline.smooth_recording(recording, config, fixes, given).track
    np.testing.assert_allclose(tracks[0].time_s, offline.time_s[1:])
    np.testing.assert_allclose(tracks[0].heading_rad, offline.heading_rad[1:], atol=1e-9)
    # Online a fix within a step comes before the step, offline in its middle.
    assert np.linalg.norm(tracks[0].position_m[-1] - offline.position_m[-1]) < 0.5
    assert (tracks[0].step_length_m > 0.3).all()


def in_pieces(blocks: list[SensorBlock], rng: np.random.Generator) -> list[Any]:
    """Pieces of all lengths, empty ones among them, in the order in which a live recorder sends them."""
    pieces: list[Any] = [piece for block in blocks for piece in cut_block(block, rng, 400)]
    filled = sorted((piece for piece in pieces if len(piece.time_s)), key=lambda piece: piece.time_s[-1])
    return [*filled[:100], *(piece for piece in pieces if not len(piece.time_s)), *filled[100:]]


@pytest.mark.slow
def test_measurements_come_in_order_of_time(user: ModuleType, recording: Recording) -> None:
    begun: list[Any] = []

    class Watched(user.Jumping):  # type: ignore[name-defined,misc]
        def begin(self, *arguments: Any) -> Any:
            begun.append(super().begin(*arguments))
            return begun[-1]

    tracker = Tracker(KNOWN_START, ["left"], parts=Parts(estimator=Watched()))
    for _, block in blocks_of(recording, in_time_order):
        tracker.push("left", block)
        if 20.0 < block.time_s[-1] < 20.01:
            tracker.push_fix(PositionFix(18.0, np.zeros(2), np.eye(2)))
    tracker.flush()
    assert begun[0].times_s == sorted(begun[0].times_s)
    assert 18.0 in begun[0].times_s


def test_an_estimator_for_whole_walks_is_refused_online(user: ModuleType) -> None:
    with pytest.raises(ConfigError, match=r"estimator whole-walk does not work online .*: track with ekf"):
        Tracker(Config(), ["left"], parts=Parts(estimator=user.WholeWalk()))


def test_a_file_names_them(folder: Path, recording: Recording, user: ModuleType) -> None:
    before = list(sys.path)
    config = load_config(folder / "settings.yaml")
    assert sys.path == before
    assert config.steps.parameters == {"threshold_mps2": 1.2}
    assert import_folders(config) == (str(folder),)
    assert external_files(config) == (folder / "user_parts.py",)
    walk = pipeline.smooth_recording(recording, config)
    objects = Parts(
        step_detector=lambda rate_hz: user.upward(rate_hz, threshold_mps2=1.2), estimator=user.Jumping(0.8)
    )
    expected = pipeline.smooth_recording(recording, KNOWN_START, parts=objects)
    assert exact_content([walk.track]) == exact_content([expected.track])
    copied = folder / "copied.yaml"
    copied.write_text(config_to_yaml(config, comments=True), encoding="utf-8")
    assert load_config(copied) == config


def test_other_parts_leave_the_parameters_behind(folder: Path, user: ModuleType) -> None:
    config = load_config(folder / "settings.yaml")
    assert config.replace({"steps.detector": "auto"}).steps.parameters == {}
    assert config.with_estimator("ekf").estimator.parameters == {}
    assert config.replace({"steps.parameters.min_interval_s": 0.4}).steps.parameters == {
        "threshold_mps2": 1.2,
        "min_interval_s": 0.4,
    }


def run_cli(*commands: Sequence[str], where: Path) -> subprocess.CompletedProcess[str]:
    """Run commands one after the other in a process of their own, which has not imported the user's module."""
    calls = "".join(f"main({list(one)!r}, standalone_mode={one is commands[-1]})\n" for one in commands)
    command = [sys.executable, "-c", f"from pdr_est.cli import main\n{calls}"]
    path = os.pathsep.join([str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    return subprocess.run(
        command, capture_output=True, text=True, cwd=where, check=False, env=os.environ | {"PYTHONPATH": path}
    )


@pytest.mark.slow
def test_an_experiment_of_another_folder_in_two_processes(folder: Path, tmp_path: Path) -> None:
    done = run_cli(("experiment", str(folder / "compare.yaml"), "-o", "out", "--workers", "2"), where=tmp_path)
    assert done.returncode == 0, done.stderr
    table = pl.read_parquet(next((tmp_path / "out").glob("*.parquet")))
    assert set(table["variant"]) == {"ours", "theirs"}
    shown = run_cli(("config", "show", str(folder / "compare.yaml")), where=tmp_path)
    assert shown.returncode == 0, shown.stderr
    assert "user_parts:upward" in shown.stdout


@pytest.mark.slow
def test_smooth_and_track_of_another_folder(folder: Path, recording: Recording, tmp_path: Path) -> None:
    write_plain_csv(recording, tmp_path / "walk.csv")
    walk, settings = str(tmp_path / "walk.csv"), str(folder / "settings.yaml")
    smoothing = ("smooth", walk, "-o", "out", "--config", settings)
    tracking = ("track", walk, "--config", settings, "-o", "out.jsonl")
    done = run_cli(smoothing, tracking, where=tmp_path)
    assert done.returncode == 0, done.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["estimator"] == "jumping"
    assert len((tmp_path / "out.jsonl").read_text(encoding="utf-8").splitlines()) > 50


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            "\nsteps.detector: nowhere.at_all:make\n",
            r"line 2: .* = 'nowhere.at_all:make': there is no module",
        ),
        (
            "steps.detector: user_parts:upwards\n",
            r"line 1: .* has no 'upwards': did you mean 'upward'",
        ),
        ("steps.detector: user_parts:NO_STAGE\n", r"line 1: .*: is <object .*>: name a class or a function"),
        ("steps.detector: user_parts:Jumping\n", r"line 1: .*: Jumping has no push, flush, latency_s: a stage needs"),
        ("estimator.name: user_parts:Passed\n", r"line 1: .*: Passed has no estimate, spec: an estimator needs"),
        (
            "steps:\n  detector: user_parts:upward\n  parameters:\n    threshold_mps2: -1\n",
            r"line \d: steps.detector = .*: UpwardParams: threshold_mps2 = -1: Input should be greater than 0",
        ),
        (
            "step_length:\n  model: user_parts:LengthByHeight\n  parameters:\n    shares: 3\n",
            r"line 4: step_length.model = .*: takes no parameter 'shares': did you mean 'share'\?",
        ),
        (
            "step_length:\n  model: user_parts:LengthByHeight\n  parameters: {walker: 3}\n",
            r"line 3: .*: parameter 'walker' is given by the pipeline: leave it out",
        ),
        (
            "estimator: {name: 'user_parts:Jumping', parameters: {gain: 7}}\n",
            r"line 1: estimator.name = .*: cannot be made \(ValueError: gain = 7: give a share\)",
        ),
        ("estimator.name: user_parts:Walker\n", r"line 1: .*: parameter 'devices' is missing: give it"),
        ("estimator.name: broken_parts:make\n", r"line 1: .*: broken_parts cannot be imported \(ZeroDivisionError"),
        ("gait.parameters: {a: 1}\n", r"line 1: gait.parameters: are for a part of your own, and gait.method = auto"),
        ("start.closed: true\nestimator.name: user_parts:Jumping\n", r"line 1: start.closed: jumping makes no use"),
        (
            "steps.detector: user_parts\n",
            r"line 1: steps.detector = 'user_parts': Input should be 'auto', ",
        ),
        ("steps.detector: json:dumps\n", r"line 1: .*: parameter 'obj' is missing"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(folder: Path, user: ModuleType, settings: str, message: str) -> None:
    (folder / "broken_parts.py").write_text("1 / 0\n", encoding="utf-8")
    path = folder / "wrong.yaml"
    path.write_text(settings, encoding="utf-8")
    with pytest.raises(ConfigError, match=rf"wrong\.yaml: {message}"):
        load_config(path)


def test_the_command_line_says_it_in_one_line(folder: Path, tmp_path: Path) -> None:
    (folder / "wrong.yaml").write_text("steps.detector: user_parts:upwards\n", encoding="utf-8")
    done = run_cli(("config", "show", str(folder / "wrong.yaml")), where=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "Traceback" not in done.stderr
    assert "wrong.yaml: line 1: steps.detector = 'user_parts:upwards'" in done.stderr


def test_another_module_of_the_same_name_is_not_taken_for_it(tmp_path: Path, user: ModuleType) -> None:
    (tmp_path / "user_parts.py").write_text(MODULE, encoding="utf-8")
    path = tmp_path / "settings.yaml"
    path.write_text("steps.detector: user_parts:upward\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"line 1: .*: another module 'user_parts' was imported from .*: rename"):
        load_config(path)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda user: Parts(step_detector=3), r"^Parts: step_detector = 3: int has no push, flush, latency_s"),
        (lambda user: Parts(estimator=user.Passed()), r"^Parts: estimator = .*: Passed has no estimate, spec"),
    ],
)
def test_objects_that_are_no_parts_are_refused(
    make: Callable[[ModuleType], Parts], message: str, user: ModuleType
) -> None:
    with pytest.raises(ConfigError, match=message):
        make(user)


def test_a_given_estimator_must_fit_the_walk(user: ModuleType, recording: Recording) -> None:
    closed = Config(start=StartParams(closed=True))
    with pytest.raises(ConfigError, match=r"start.closed: jumping makes no use of a walk that ends where it began"):
        pipeline.smooth_recording(recording, closed, parts=Parts(estimator=user.Jumping()))

    class Nothing(user.Jumping):  # type: ignore[name-defined,misc]
        def estimate(self, *_: Any) -> None:
            return None

    with pytest.raises(EstimationError, match=r"estimator jumping returned NoneType: it must return a Track of"):
        pipeline.smooth_recording(recording, KNOWN_START, parts=Parts(estimator=Nothing()))


def test_the_table_names_every_estimator() -> None:
    assert list(SPECS) == [spec.name for spec in SPECS.values()]
    assert [name for name, spec in SPECS.items() if spec.smooths] == ["factor-graph", "particle"]
    assert [name for name, spec in SPECS.items() if spec.online] == ["ekf", "fixed-lag", "particle"]
    assert EstimatorSpec("mine") == EstimatorSpec("mine", uses_fixes=True)
