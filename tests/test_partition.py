"""The contract of every stage: what it emits does not depend, to the last bit, on how its input was cut.

Each stage is tested alone and the whole chain as well, because a slow stage can hide a fault of a fast one.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from inspect import isclass
from pkgutil import walk_packages
from typing import Any, Literal

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pdr_est import front_end
from pdr_est.config import Config
from pdr_est.front_end.attitude import AccelerometerTilt, AttitudeParams, DeviceAttitude, VqfAttitude
from pdr_est.front_end.gait import GaitClassifier, UnknownGait, shipped_model
from pdr_est.front_end.heading import HEADINGS, HeadingName, HeadingParams
from pdr_est.front_end.heading.acceleration_integration import AccelerationIntegration, AccelerationIntegrationParams
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.online_course import OnlineCourse
from pdr_est.front_end.heading.hde_controller import HdeParams
from pdr_est.front_end.heading.magnetometer import MagnetometerHeading
from pdr_est.front_end.heading.mmpdr_aoc import MmpdrHeading, MmpdrHeadingParams
from pdr_est.front_end.heading.north import NorthParams, NorthPriors, NorthReference
from pdr_est.front_end.heading.posture_aware_yaw import AutoHeadingParams, PostureAwareYaw
from pdr_est.front_end.heading.principal_axis import PrincipalAxis, PrincipalAxisParams
from pdr_est.front_end.heading.psp import PspHeading
from pdr_est.front_end.heading.step_yaw import StepYaw
from pdr_est.front_end.heading.tie_controller import TieParams
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams
from pdr_est.front_end.heading.whole_walk.drift_correction import WholeWalkHeading
from pdr_est.front_end.mode import (
    AutoModeParams,
    FixedMode,
    HmmModeRecogniser,
    MmpdrMode,
    MmpdrModeParams,
    ModeParams,
)
from pdr_est.front_end.odometry import Odometry, OdometryParams
from pdr_est.front_end.signal.blocks import join
from pdr_est.front_end.step_length import StairParams, StepLength, StepLengthParams, WalkerParams
from pdr_est.front_end.step_length.stairs import StairLengths
from pdr_est.front_end.steps import DETECTORS, DetectorName, StepsParams
from pdr_est.front_end.steps.bandpass_peaks import AutoStepParams, BandpassPeakDetector
from pdr_est.front_end.steps.local_variance import LocalVariance, LocalVarianceParams
from pdr_est.front_end.steps.magnitude_peaks import MagnitudePeaks, MagnitudePeaksParams
from pdr_est.front_end.steps.mmpdr_peaks import MmpdrStepParams, MmpdrSteps
from pdr_est.front_end.steps.relative_threshold import RelativeThreshold, RelativeThresholdParams
from pdr_est.front_end.steps.segmentation import SegmentationParams, StepSegmentation
from pdr_est.front_end.steps.uptime_fsm import UptimeFsm, UptimeFsmParams
from pdr_est.front_end.steps.zero_crossing import ZeroCrossing, ZeroCrossingParams
from pdr_est.pipeline.front_end_chain import levelling, measuring, stepping
from pdr_est.preprocessing.resampling import ResampleParams, Resampler
from pdr_est.preprocessing.trim import trim_recording
from pdr_est.simulate import PHONE_MAGNETOMETER, mmpdr_mode_walks, simulate_walk
from pdr_est.stage import Chain, Stage
from pdr_est.testing import (
    check_partition,
    check_stage,
    cut_block,
    cut_finely,
    cut_randomly,
    in_bursts,
    in_time_order,
    messy_device,
    one_by_one,
    run_stage,
    slice_block,
)
from pdr_est.types.measurements import HeadingPrior
from pdr_est.types.recording import DeviceRecording, Recording, Signal
from pdr_est.types.sensors import Channel, LevelBlock
from pdr_est.types.steps import CarryingMode

RATES_HZ = (25.0, 50.0, 100.0, 400.0)
FEW_RATES_HZ = [pytest.param(rate, marks=[] if rate in (50.0, 400.0) else pytest.mark.slow) for rate in RATES_HZ]
WORKING_HZ = 50.0
FOUR_WAYS = DominantParams(number=4)  # used whatever the walk tells


def auto_steps() -> Stage:
    return BandpassPeakDetector(WORKING_HZ, AutoStepParams())


def short_sighted(spoilt_hops: int, ahead_hops: int) -> Stage:
    return HmmModeRecogniser(WORKING_HZ, AutoModeParams(spoilt_hops=spoilt_hops, ahead_hops=ahead_hops))


def mmpdr() -> Stage:
    return MmpdrSteps(WORKING_HZ, MmpdrStepParams())


@dataclass(frozen=True)
class Case:
    """A stage, and which records of the chain it consumes."""

    make: Callable[[], Stage]
    consumes: str


CASES = {
    "Resampler": Case(lambda: Resampler(tuple(CHANNELS), ResampleParams()), "raw"),
    "VqfAttitude": Case(lambda: VqfAttitude(WORKING_HZ, AttitudeParams()), "imu"),
    "DeviceAttitude": Case(DeviceAttitude, "imu"),
    "AccelerometerTilt": Case(lambda: AccelerometerTilt(WORKING_HZ, AttitudeParams()), "imu"),
    "FixedMode": Case(lambda: FixedMode(CarryingMode.HOLDING), "level"),
    "HmmModeRecogniser": Case(lambda: HmmModeRecogniser(WORKING_HZ, AutoModeParams()), "level"),
    "AutoMode-0-0": Case(lambda: short_sighted(0, 0), "level"),
    "AutoMode-0-3": Case(lambda: short_sighted(0, 3), "level"),
    "AutoMode-3-0": Case(lambda: short_sighted(3, 0), "level"),
    "MmpdrMode": Case(lambda: MmpdrMode(WORKING_HZ, MmpdrModeParams()), "level"),
    "LocalVariance": Case(lambda: LocalVariance(WORKING_HZ, LocalVarianceParams()), "level"),
    "RelativeThreshold": Case(lambda: RelativeThreshold(WORKING_HZ, RelativeThresholdParams()), "level"),
    "UptimeFsm": Case(lambda: UptimeFsm(WORKING_HZ, UptimeFsmParams()), "level"),
    "ZeroCrossing": Case(lambda: ZeroCrossing(WORKING_HZ, ZeroCrossingParams()), "level"),
    "MagnitudePeaks": Case(lambda: MagnitudePeaks(WORKING_HZ, MagnitudePeaksParams()), "level"),
    "BandpassPeakDetector": Case(auto_steps, "level"),
    "MmpdrSteps": Case(mmpdr, "level"),
    "StepSegmentation-AutoSteps": Case(lambda: StepSegmentation(auto_steps(), SegmentationParams()), "level"),
    "StepSegmentation-MmpdrSteps": Case(lambda: StepSegmentation(mmpdr(), SegmentationParams()), "level"),
    "GaitClassifier": Case(lambda: GaitClassifier(shipped_model("auto")), "steps"),
    "GaitClassifier-uptime": Case(lambda: GaitClassifier(shipped_model("uptime")), "steps"),
    "UnknownGait": Case(UnknownGait, "steps"),
    "StepLength": Case(lambda: StepLength(WORKING_HZ, WalkerParams(), StepLengthParams()), "steps"),
    "StepYaw": Case(StepYaw, "steps"),
    "MagnetometerHeading": Case(MagnetometerHeading, "steps with field"),
    "PostureAwareYaw": Case(lambda: PostureAwareYaw(AutoHeadingParams(), PrincipalAxisParams()), "steps"),
    "OnlineCourse": Case(lambda: OnlineCourse(CourseParams()), "complete steps"),
    "HeadingHindsight-priors": Case(lambda: WholeWalkHeading(FOUR_WAYS, as_priors=True), "complete steps"),
    "HeadingHindsight-increments": Case(lambda: WholeWalkHeading(FOUR_WAYS, as_priors=False), "complete steps"),
    "MmpdrHeading": Case(lambda: MmpdrHeading(MmpdrHeadingParams()), "steps"),
    "PspHeading": Case(lambda: PspHeading(WORKING_HZ, HdeParams(), TieParams(), priors=True), "steps"),
    "PspHeading-gyro": Case(lambda: PspHeading(WORKING_HZ, None, None, priors=False), "steps"),
    "AccelerationIntegration": Case(
        lambda: AccelerationIntegration(WORKING_HZ, AccelerationIntegrationParams()), "steps"
    ),
    "PrincipalAxis": Case(lambda: PrincipalAxis(PrincipalAxisParams()), "steps"),
    "NorthPriors": Case(
        lambda: NorthPriors("device", NorthReference("magnetometer"), NorthParams(least_steps=1), 0.02),
        "complete steps with field",
    ),
    "StairLengths": Case(lambda: StairLengths(StairParams()), "complete steps"),
    "Odometry": Case(lambda: Odometry("device", OdometryParams()), "complete steps"),
}
_TO_STEPS = ("VqfAttitude", "FixedMode", "StepSegmentation-AutoSteps")
CHANNELS = (Channel.SPECIFIC_FORCE, Channel.ROTATION_RATE, Channel.ATTITUDE)
CONFIGS = {
    f"{source}-{detector}": replace(
        Config(), attitude=AttitudeParams(source=source), steps=StepsParams(detector=detector)
    )
    for source in ("vqf", "device")
    for detector in ("auto", "mmpdr")
}


@cache
def device(rate_hz: float, seed: int = 1) -> DeviceRecording:
    return messy_device(rate_hz, seed)


@cache
def records(consumed: str, rate_hz: float) -> tuple[Any, ...]:
    """The records of the messy recording at one place of the chain, from uncut input."""
    if consumed == "raw":
        return tuple(device(rate_hz).blocks())
    before, stage = {
        "imu": ("raw", CASES["Resampler"].make()),
        "level": ("imu", Chain([CASES["VqfAttitude"].make(), FixedMode(CarryingMode.HOLDING)])),
        "steps": ("level", CASES["StepSegmentation-AutoSteps"].make()),
        "steps with field": ("raw", with_field()),
        "complete steps with field": ("steps with field", Chain([CASES["StepLength"].make(), StepYaw()])),
        "complete steps": ("steps", Chain([CASES["StepLength"].make(), StepYaw()])),
    }[consumed]
    return tuple(run_stage(stage, records(before, rate_hz))[0])


def with_field() -> Chain:
    """From samples to steps with the magnetic field, for recordings whose channels come one after the other."""
    resampler = Resampler(CHANNELS, ResampleParams(), optional=(Channel.MAGNETIC_FIELD,))
    return Chain([resampler, *(CASES[name].make() for name in _TO_STEPS)])


def whole_chain(config: Config, rate_hz: float) -> Chain:
    _, to_level = levelling(device(rate_hz), "messy", config)
    return Chain([*to_level.stages, *stepping(config).stages, Odometry("device", config.odometry)])


def bookkeeping(stage: Any) -> Any:
    """What a resampler tells besides its outputs."""
    first = stage.stages[0] if isinstance(stage, Chain) else stage
    return (first.gaps, first.dropped) if isinstance(first, Resampler) else None


def check_cuts(make: Callable[[], Any], items: Sequence[Any], cuttings: Sequence[list[Any]], seed: int = 0) -> None:
    check_partition(make, items, cuttings, seed, compare=bookkeeping)


def test_every_stage_of_the_front_end_is_tested() -> None:
    modules = [import_module(info.name) for info in walk_packages(front_end.__path__, "pdr_est.front_end.")]
    stages = {
        name
        for module in modules
        for name, item in vars(module).items()
        if isclass(item) and item.__module__ == module.__name__ and {"push", "flush"} <= set(vars(item))
    }
    assert stages == {type(case.make()).__name__ for case in CASES.values()} - {"Resampler"}


@pytest.mark.parametrize("rate_hz", RATES_HZ)
def test_the_messy_recording_is_a_hard_one(rate_hz: float) -> None:
    resampler = CASES["Resampler"].make()
    segments = {block.segment for block in run_stage(resampler, records("raw", rate_hz))[0]}
    assert len(segments) == 4
    assert isinstance(resampler, Resampler)
    assert {key.split(": ")[1] for key in resampler.dropped} == {"not finite", "duplicate time", "backward time"}
    assert sum("clock reset" in gap.reason for gap in resampler.gaps) == len(CHANNELS)
    steps = records("complete steps", rate_hz)
    assert len(steps) >= 8
    assert len({step.event.segment for step in steps}) >= 3


@pytest.mark.parametrize("rate_hz", FEW_RATES_HZ)
@pytest.mark.parametrize("name", CASES)
def test_random_cuts_of_a_stage(name: str, rate_hz: float) -> None:
    rng = np.random.default_rng(int(rate_hz))
    items = records(CASES[name].consumes, rate_hz)
    check_cuts(CASES[name].make, items, [cut_randomly(items, rng) for _ in range(3)], seed=int(rate_hz))


@pytest.mark.parametrize("name", CASES)
def test_every_stage_keeps_the_contract(name: str) -> None:
    check_stage(CASES[name].make, records(CASES[name].consumes, 50.0))


@pytest.mark.parametrize("rate_hz", [50.0])
@pytest.mark.parametrize("name", CASES)
def test_one_sample_at_a_time_through_a_stage(name: str, rate_hz: float) -> None:
    items = records(CASES[name].consumes, rate_hz)
    check_cuts(CASES[name].make, items, [cut_finely(items)])


@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case.consumes == "level"])
def test_stages_on_noise(name: str) -> None:
    """Noise has extrema at every distance from each other and modes that change, hence borders that no walk shows."""
    rng = np.random.default_rng(5)
    items = [with_noise(block, rng) for block in records("level", 50.0)]
    cuttings = [cut_finely(items), cut_randomly(items, rng)]
    check_cuts(CASES[name].make, items, cuttings)


def with_noise(block: LevelBlock, rng: np.random.Generator) -> LevelBlock:
    force = 10.0 * rng.standard_normal((len(block), 3))
    return replace(
        block,
        acceleration_mps2=force,
        vertical_mps2=np.sum(force * block.up, axis=1),
        rotation_rate_radps=rng.standard_normal((len(block), 3)),
        mode=rng.choice(list(CarryingMode), len(block)).astype(np.int8),
    )


@cache
def with_magnetometer() -> DeviceRecording:
    """A walk with changing modes, its magnetometer with a pause and an early end."""
    scenario = mmpdr_mode_walks(people=2)[1]
    sensors = replace(scenario.devices[0].sensors, magnetometer=PHONE_MAGNETOMETER)
    carried = replace(scenario.devices[0], sensors=sensors)
    whole = simulate_walk(replace(scenario, devices=(carried,))).recording.devices[0]
    field = whole.magnetic_field
    assert field is not None
    kept = (field.time_s < 20.0) | ((field.time_s > 25.0) & (field.time_s < 40.0))
    return replace(whole, magnetic_field=Signal(field.time_s[kept], field.values[kept]))


@cache
def short_walk() -> DeviceRecording:
    """The beginning of that walk, whose magnetometer pauses and ends earlier still."""
    (whole,) = trim_recording(Recording("short", "simulated", (with_magnetometer(),)), 0.0, 20.0).devices
    field = whole.magnetic_field
    assert field is not None
    kept = (field.time_s < 9.0) | ((field.time_s > 12.0) & (field.time_s < 17.0))
    return replace(whole, magnetic_field=Signal(field.time_s[kept], field.values[kept]))


@cache
def changing_modes() -> tuple[LevelBlock, ...]:
    """The level samples of a walk with all three modes and the transitions between them, with a gap of 2 s that
    begins within a transition."""
    device = with_magnetometer()
    config = Config(mode=ModeParams(method="mmpdr"), heading=HeadingParams(method="magnetometer"))
    block = join(run_stage(levelling(device, "changing", config)[1], device.blocks())[0])
    middle = int(np.flatnonzero(block.mode == CarryingMode.TRANS)[-20])
    late = slice_block(block, middle + 100, len(block))
    return slice_block(block, 0, middle), replace(late, segment=1)


def test_the_changing_modes_are_all_there() -> None:
    found = np.concatenate([block.mode for block in changing_modes()])
    assert {CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET, CarryingMode.TRANS} <= set(found.tolist())
    events = run_stage(mmpdr(), changing_modes())[0]
    assert sum(event.mode is CarryingMode.TRANS for event in events) >= 6


@pytest.mark.parametrize("heading", HEADINGS)
def test_cuts_where_modes_change(heading: HeadingName) -> None:
    """The state machine and the stages that follow it, from samples to odometry."""
    rng = np.random.default_rng(11)
    config = Config(
        mode=ModeParams(method="mmpdr"), steps=StepsParams(detector="mmpdr"), heading=HeadingParams(method=heading)
    )

    def chain() -> Chain:
        mode = MmpdrMode(WORKING_HZ, MmpdrModeParams())
        return Chain([mode, *stepping(config).stages, Odometry("device", config.odometry)])

    check_cuts(chain, changing_modes(), [cut_randomly(changing_modes(), rng) for _ in range(2)])


def test_cuts_of_the_steps_where_modes_change() -> None:
    rng = np.random.default_rng(11)
    cuttings = [cut_randomly(changing_modes(), rng) for _ in range(6)]
    check_cuts(mmpdr, changing_modes(), [*cuttings, one_by_one(changing_modes())])


@pytest.mark.parametrize("rate_hz", FEW_RATES_HZ)
@pytest.mark.parametrize("config", CONFIGS.values(), ids=CONFIGS)
def test_random_cuts_of_the_chain(config: Config, rate_hz: float) -> None:
    rng = np.random.default_rng(int(rate_hz))
    items = records("raw", rate_hz)
    cuttings = [cut_randomly(items, rng) for _ in range(2)]
    check_cuts(lambda: whole_chain(config, rate_hz), items, cuttings, seed=int(rate_hz))


@pytest.mark.parametrize("detector", DETECTORS)
def test_cuts_of_the_chain_without_gyroscope(detector: DetectorName) -> None:
    config = Config(steps=StepsParams(detector=detector))
    bare = replace(device(50.0), rotation_rate=None, attitude=None)
    items = tuple(bare.blocks())
    rng = np.random.default_rng(7)

    def chain() -> Chain:
        return Chain([*levelling(bare, "messy", config)[1].stages, *stepping(config).stages])

    check_cuts(chain, items, [cut_randomly(items, rng), one_by_one(items)])


@pytest.mark.parametrize("name", ["vqf-auto", pytest.param("device-mmpdr", marks=pytest.mark.slow)])
def test_one_sample_at_a_time_through_the_chain(name: str) -> None:
    items = records("raw", 50.0)
    cuttings = [in_time_order(items), one_by_one(items)]
    check_cuts(lambda: whole_chain(CONFIGS[name], 50.0), items, cuttings)


@pytest.mark.slow
@pytest.mark.parametrize("rate_hz", RATES_HZ)
@pytest.mark.parametrize("config", CONFIGS.values(), ids=CONFIGS)
def test_many_recordings_in_many_cuts(config: Config, rate_hz: float) -> None:
    rng = np.random.default_rng(int(rate_hz) + 1)
    for seed in range(2, 5):
        items = tuple(device(rate_hz, seed).blocks())
        cuttings = [cut_randomly(items, rng) for _ in range(8)] + [in_time_order(items)]
        check_cuts(lambda: whole_chain(config, rate_hz), items, cuttings)


def test_cuts_of_the_chain_with_a_magnetometer() -> None:
    """It may come a little later than the others, pauses, and stops early; the others go on, and no cut matters."""
    config = Config(heading=HeadingParams(method="magnetometer"))
    fitted = short_walk()
    items, rng = tuple(fitted.blocks()), np.random.default_rng(13)

    def chain() -> Chain:
        _, to_level = levelling(fitted, "fitted", config)
        return Chain([*to_level.stages, *stepping(config).stages, Odometry("device", config.odometry)])

    cuttings = [
        in_bursts([one_by_one([block]) for block in items], 1.9, rng),
        in_bursts([cut_block(block, rng, 3000) for block in items], 1.0, rng),
    ]
    check_cuts(chain, items, cuttings)


@pytest.mark.parametrize("source", ["device", pytest.param("magnetometer", marks=pytest.mark.slow)])
def test_cuts_of_the_chain_with_north(source: Literal["device", "magnetometer"]) -> None:
    """The channel that tells north may come a little later than the others, too."""
    config, north = Config(), NorthReference(source)
    fitted = short_walk()
    turned = Rotation.from_rotvec(np.outer(0.1 * fitted.span_s[1] * np.linspace(0.0, 1.0, 2000), [0.0, 0.0, 1.0]))
    time_s = np.linspace(*fitted.span_s, 2000)
    fitted = replace(fitted, attitude=Signal(time_s, turned.as_quat(scalar_first=True)))
    items, rng = tuple(fitted.blocks()), np.random.default_rng(17)

    def chain() -> Chain:
        _, to_level = levelling(fitted, "fitted", config, north=north)
        return Chain([*to_level.stages, *stepping(config).stages, measuring("device", config, north)])

    emitted = run_stage(chain(), items)[0]
    assert any(isinstance(one, HeadingPrior) and not one.relative for one in emitted)
    check_cuts(chain, items, [in_bursts([cut_block(block, rng, 3000) for block in items], 1.9, rng)])
