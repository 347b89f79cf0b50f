"""Steps on stairs by the vertical motion of the whole walk: made-up walks on a known staircase."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from signals import RATE_HZ, corner_walk, level, run

from pdr_est.config import Config
from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.front_end.heading.step_yaw import StepYaw
from pdr_est.front_end.signal.blocks import part
from pdr_est.front_end.step_length import StairParams, StepLengthParams, stairs_stage, step_length_stage
from pdr_est.front_end.step_length.stairs import StairLengths
from pdr_est.front_end.step_length.stairs.flight_hypotheses import FlightHypotheses
from pdr_est.online.saved_state import pack, unpack
from pdr_est.parts import Parts
from pdr_est.pipeline import analyse_recording
from pdr_est.pipeline.front_end_chain import levelling, whole_walk_corrections
from pdr_est.simulate import simulate_walk
from pdr_est.simulate.people.population import CarryingName, PopulationParams, sample_population
from pdr_est.types.measurements import StepOdometry
from pdr_est.types.recording import Recording, Signal
from pdr_est.types.steps import CarryingMode, Step, StepEvent

COUNT = 28  # samples of a step, 0.56 s
RISE_M, LENGTH_M, SIGMA_M = 0.16, 0.7, 0.05
UP, DOWN, LEVEL = 1, -1, 0
FLIGHT = [LEVEL] * 20 + [UP] * 12 + [LEVEL] * 25


def walk(
    climbs: Sequence[int],
    *,
    bias_mps2: float = 0.0,
    extra_mps: Array | None = None,
    pressure_of: Sequence[int] | None = None,
    mode: CarryingMode = CarryingMode.HOLDING,
    seed: int = 0,
) -> list[Step]:
    """Steps of 0.56 s that go level, up or down by a stair each; the phone has an accelerometer with noise.

    Parameters
    ----------
    climbs : sequence of int
        Direction of each step.
    bias_mps2 : float
        Constant error of the vertical acceleration.
    extra_mps : ndarray or None
        Vertical velocity (n,) of the phone against the body at each sample.
    pressure_of : sequence of int or None
        Directions by which the air pressure changes, with a noise of 3 Pa; None for a phone without barometer.
    mode : CarryingMode
        Carrying mode of all steps.
    """
    generator = np.random.default_rng(seed)
    velocity_mps = np.repeat(np.array(climbs) * RISE_M * RATE_HZ / COUNT, COUNT)
    velocity_mps = np.convolve(np.pad(velocity_mps, COUNT // 2, mode="edge"), np.full(COUNT, 1.0 / COUNT), "valid")
    velocity_mps = velocity_mps[: COUNT * len(climbs)] + (0.0 if extra_mps is None else extra_mps)
    phase = 2.0 * np.pi * np.arange(len(velocity_mps)) / COUNT
    vertical = np.gradient(velocity_mps) * RATE_HZ + 2.5 * np.sin(phase) + bias_mps2
    samples = level(vertical + generator.normal(0.0, 0.2, len(vertical)))
    if pressure_of is not None:
        height_m = np.cumsum(np.repeat(np.array(pressure_of) * RISE_M / COUNT, COUNT))
        pressure_pa = 100_000.0 * np.exp(-height_m / 8435.0) + generator.normal(0.0, 3.0, len(height_m))
        samples = replace(samples, pressure_pa=pressure_pa)
    return [
        Step(
            StepEvent((k + 1) * COUNT - 1, ((k + 1) * COUNT - 1) / RATE_HZ, 0, mode),
            (k * COUNT - 1) / RATE_HZ,
            0.0 if k == 0 else RATE_HZ / COUNT,
            part(samples, k * COUNT, (k + 1) * COUNT),
            length_m=LENGTH_M,
            sigma_length_m=SIGMA_M,
        )
        for k in range(len(climbs))
    ]


def probabilities(steps: Sequence[Step], parameters: StairParams | None = None) -> Array:
    """Probability of each step to lie on stairs."""
    found = run(StairLengths(parameters or StairParams()), steps)
    assert [step.event for step in found] == [step.event for step in steps]
    return np.array([step.stairs_probability for step in found])


@pytest.mark.parametrize("direction", [UP, DOWN])
@pytest.mark.parametrize("bias_mps2", [0.0, 0.15, -0.15])
def test_a_flight_is_found_up_and_down_whatever_the_error_of_the_accelerometer(
    direction: int, bias_mps2: float
) -> None:
    p = probabilities(walk([direction * climb for climb in FLIGHT], bias_mps2=bias_mps2))
    assert p[21:31].min() > 0.9
    assert max(p[:18].max(), p[35:].max()) < 0.05


def test_the_length_is_that_of_the_tread_and_in_doubt_the_spread_says_so() -> None:
    parameters = StairParams()
    for step in run(StairLengths(parameters), walk(FLIGHT)):
        p = step.stairs_probability
        assert step.length_m == pytest.approx((1.0 - p) * LENGTH_M + p * parameters.tread_m)
        between = p * (1.0 - p) * (LENGTH_M - parameters.tread_m) ** 2
        assert step.sigma_length_m == pytest.approx(
            np.sqrt((1.0 - p) * SIGMA_M**2 + p * parameters.sigma_tread_m**2 + between)
        )


def test_two_flights_with_a_landing_between_them() -> None:
    climbs = [LEVEL] * 20 + [DOWN] * 10 + [LEVEL] * 4 + [DOWN] * 10 + [LEVEL] * 20
    p = probabilities(walk(climbs))
    assert min(p[21:29].min(), p[35:43].min()) > 0.9
    assert p[31:33].max() < 0.5
    assert p[-15:].max() < 0.05


@pytest.mark.parametrize("seed", range(5))
def test_level_walking_is_left_exactly_as_it_is(seed: int) -> None:
    steps = walk([LEVEL] * 150, bias_mps2=0.05, seed=seed)
    assert all(out is step for out, step in zip(run(StairLengths(StairParams()), steps), steps, strict=True))


def sway_mps(steps: int, seed: int = 0) -> Array:
    """Vertical velocity of an unsteady hand at each sample: slow oscillations, 0.12 m/s (one standard deviation)."""
    generator = np.random.default_rng(seed)
    time_s = np.arange(steps * COUNT) / RATE_HZ
    tones = zip(generator.uniform(0.35, 0.5, 8), generator.uniform(0.0, 2.0 * np.pi, 8), strict=True)
    return 0.06 * sum(np.sin(2.0 * np.pi * hz * time_s + phase) for hz, phase in tones)


@pytest.mark.parametrize("seed", range(4))
def test_an_unsteady_hand_is_no_flight_from_the_first_step_on(seed: int) -> None:
    assert probabilities(walk([LEVEL] * 150, extra_mps=sway_mps(150, seed), seed=seed)).max() < 0.1


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_flight_is_found_with_an_unsteady_hand_too(seed: int) -> None:
    climbs = [LEVEL] * 60 + [UP] * 14 + [LEVEL] * 40
    p = probabilities(walk(climbs, extra_mps=sway_mps(len(climbs), seed), seed=seed))
    assert p[62:72].min() > 0.8
    assert max(p[:55].max(), p[80:].max()) < 0.05


@pytest.mark.parametrize("seed", range(3))
def test_one_flight_after_the_other_is_not_taken_for_the_noise_of_the_walk(seed: int) -> None:
    landing = [LEVEL] * 7
    p = probabilities(walk([LEVEL] * 30 + ([UP] * 9 + landing + [DOWN] * 9 + landing) * 6 + [LEVEL] * 20, seed=seed))
    flights = p[30:222].reshape(12, 16)
    assert flights[:, 1:8].mean() > 0.85
    assert flights[:, 11:14].mean() < 0.05


def test_putting_the_phone_away_and_taking_it_out_is_no_flight() -> None:
    """In the pocket its vertical velocity is anything, and so is that at which it comes out."""
    steps = walk([LEVEL] * 140, extra_mps=np.where(np.arange(140 * COUNT) < 90 * COUNT, 0.0, 0.6))
    modes = [CarryingMode.HOLDING] * 50 + [CarryingMode.POCKET] * 40 + [CarryingMode.HOLDING] * 50
    moved = [replace(step, event=replace(step.event, mode=mode)) for step, mode in zip(steps, modes, strict=True)]
    assert probabilities(moved).max() < 0.05


def test_a_carrying_mode_that_is_wrong_for_a_moment_does_not_hide_a_flight() -> None:
    steps = walk(FLIGHT)
    steps[25:28] = [replace(step, event=replace(step.event, mode=CarryingMode.POCKET)) for step in steps[25:28]]
    assert probabilities(steps)[21:31].min() > 0.9


@pytest.mark.parametrize("carrying", [("HOLDING",), ("SWING",), ("POCKET",), ("HOLDING", "SWING", "HOLDING")])
def test_simulated_walks_on_one_floor_have_no_stairs_and_hardly_wake_the_hypotheses(
    carrying: tuple[CarryingName, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    add = FlightHypotheses.add
    monkeypatch.setattr(FlightHypotheses, "add", lambda self, motion: asked.append(motion) or add(self, motion))
    population = PopulationParams(number=2, people=2, duration_s=90.0, carrying=(carrying,), rate_hz=50.0)
    steps: list[Step] = []
    for person in sample_population(population):
        (device,) = analyse_recording(simulate_walk(person.scenario).recording, Config(), at_the_end=False)
        steps += device.steps
        assert probabilities(device.steps).max() < 0.1
    assert len(asked) < 0.2 * len(steps)


def test_wherever_the_steps_are_cut_the_probabilities_are_the_same_to_the_last_bit() -> None:
    steps = [*walk(FLIGHT), *walk([LEVEL] * 40 + FLIGHT, extra_mps=sway_mps(40 + len(FLIGHT)))]
    whole = probabilities(steps)
    for cuts in ([1], [23, 24, 25], [7, 40, 41, 90], list(range(1, len(steps)))):
        stage = StairLengths(StairParams())
        pieces = zip([0, *cuts], [*cuts, len(steps)], strict=True)
        found = [out for begin, end in pieces for out in stage.push_all(steps[begin:end])]
        np.testing.assert_array_equal([step.stairs_probability for step in [*found, *stage.flush()]], whole)


def test_raising_the_phone_is_no_flight() -> None:
    """By 30 cm within a second, at 0.3 m/s and more."""
    raised_mps = np.zeros(60 * COUNT)
    raised_mps[1000:1050] = 0.3 * (1.0 - np.cos(np.linspace(0.0, 2.0 * np.pi, 50)))
    assert probabilities(walk([LEVEL] * 60, extra_mps=raised_mps)).max() < 0.1


def test_steps_that_limp_are_no_stairs() -> None:
    """A phone in a trouser pocket goes up with one leg and down with the other."""
    limp_mps = np.repeat(np.tile([0.15, -0.15], 40), COUNT)
    assert probabilities(walk([LEVEL] * 80, extra_mps=limp_mps)).max() < 0.1


def test_a_lasting_change_of_the_velocity_is_in_doubt_and_the_air_pressure_decides() -> None:
    """The recording ends before the flight does: a turn of the phone may do that to the accelerometer, too."""
    climbs = [LEVEL] * 25 + [UP] * 9
    alone = probabilities(walk(climbs))[-6:]
    climbing = probabilities(walk(climbs, pressure_of=climbs))[-6:]
    staying = probabilities(walk(climbs, pressure_of=[LEVEL] * len(climbs)))[-6:]
    assert staying.max() < 0.1 < alone.min() < climbing.min()
    assert climbing.min() > 0.95
    assert alone.max() < 0.95


def test_the_air_pressure_alone_of_a_lift_or_of_weather_is_no_stairs() -> None:
    weather = [0, 0, 1] * 60  # 10 cm a second would be a storm
    assert probabilities(walk([LEVEL] * 180, pressure_of=[0] * 60 + weather[:60] + [0] * 60)).max() < 0.2


@pytest.mark.parametrize("mode", [CarryingMode.SWING, CarryingMode.TRANS, CarryingMode.POCKET])
def test_a_phone_that_is_not_held_tells_nothing(mode: CarryingMode) -> None:
    assert not probabilities(walk(FLIGHT, mode=mode)).any()


def test_nobody_runs_on_stairs() -> None:
    steps = [
        replace(step, start_s=step.event.time_s - 0.36, gait_probability=(0.0, 0.5, 0.5)) for step in walk(FLIGHT)
    ]
    assert not probabilities(steps).any()


def test_a_gap_is_no_change_of_the_velocity() -> None:
    first, second = walk([LEVEL] * 30), walk([LEVEL] * 30, bias_mps2=0.3, seed=1)
    assert probabilities([*first, *second]).max() < 0.1


@pytest.mark.slow
def test_saved_and_restored_between_any_two_steps_it_goes_on_the_same() -> None:
    steps, stage = walk(FLIGHT), StairLengths(StairParams())
    found = []
    for step in steps:
        found += stage.push(step)
        stage = unpack(pack(stage), StairLengths)
    np.testing.assert_array_equal(
        [step.stairs_probability for step in [*found, *stage.flush()]], probabilities(steps)
    )


def test_a_long_walk_is_not_kept_until_its_end() -> None:
    stage = StairLengths(StairParams())
    found = [out for step in walk([LEVEL, LEVEL, *FLIGHT] * 4) for out in stage.push(step)]
    assert len(found) > 3 * len(FLIGHT)


def test_published_models_have_no_stairs() -> None:
    assert stairs_stage(StepLengthParams()) is not None
    assert stairs_stage(StepLengthParams(model="weinberg")) is None
    assert stairs_stage(StepLengthParams(stairs=StairParams(enabled=False))) is None


def with_pressure(recording: Recording, pressure: Signal) -> Recording:
    return replace(recording, devices=(replace(recording.devices[0], pressure=pressure),))


def test_the_air_pressure_of_a_recording_reaches_the_steps_and_changes_no_level_walk() -> None:
    recording = corner_walk().recording
    device = recording.devices[0]
    time_s = device.specific_force.time_s
    pressure = Signal(time_s, np.full((len(time_s), 1), 101_000.0))
    (plain,) = analyse_recording(recording, Config())
    (with_it,) = analyse_recording(with_pressure(recording, pressure), Config())
    assert plain.level[0].pressure_pa is None
    np.testing.assert_allclose(with_it.level[0].pressure_pa[:-1], 101_000.0)
    for one, other in zip(plain.steps, with_it.steps, strict=True):
        assert one.length_m == other.length_m
        np.testing.assert_allclose(other.samples.pressure_pa, 101_000.0)


def test_beside_a_length_stage_of_ones_own_there_are_no_stairs_and_no_pressure_is_needed() -> None:
    recording, config = corner_walk().recording, Config()
    time_s = recording.devices[0].specific_force.time_s
    (device,) = with_pressure(recording, Signal(time_s, np.full((len(time_s), 1), 101_000.0))).devices
    own = Parts(step_length=step_length_stage(RATE_HZ, config.walker, config.step_length))
    for parts, known in ((Parts(), True), (own, False)):
        _, to_level = levelling(device, "phone", config, parts)
        assert (run(to_level, device.blocks())[0].pressure_pa is not None) == known
        assert (whole_walk_corrections(config, parts).stairs is not None) == known


def test_corrections_of_the_whole_walk_follow_the_methods_and_leave_parts_of_ones_own_alone() -> None:
    both = whole_walk_corrections(Config())
    assert both.stages == (both.stairs, both.heading)
    assert None not in both.stages
    only_heading = whole_walk_corrections(Config().replace({"step_length.model": "weinberg"}))
    assert only_heading.stages == (only_heading.heading,)
    assert whole_walk_corrections(Config(), Parts(heading=StepYaw())).heading is None


def test_shares_of_the_same_steps_do_not_exceed_all_of_them() -> None:
    with pytest.raises(ConfigError, match=r"share_disturbed = 0\.8 and share_of_jumps = 0\.3 .* at most 1"):
        StairParams(share_disturbed=0.8, share_of_jumps=0.3)
    StairParams(share_disturbed=0.8, share_of_jumps=0.2)


def test_smoothing_estimators_get_the_shorter_steps_and_filters_do_not() -> None:
    """A walk with one fake flight: 0.3 m/s upwards for 5 s, added to the accelerometer of a level walk."""
    recording = corner_walk().recording
    device = recording.devices[0]
    force, time_s = device.specific_force, device.specific_force.time_s
    begin_s = time_s[0] + 18.0
    upwards = 0.3 * ((time_s > begin_s) & (time_s < begin_s + 0.5)) / 0.5
    upwards = upwards - 0.3 * ((time_s > begin_s + 5.0) & (time_s < begin_s + 5.5)) / 0.5
    up = force.values.mean(axis=0) / np.linalg.norm(force.values.mean(axis=0))
    climbing = replace(device, specific_force=Signal(time_s, force.values + upwards[:, None] * up))
    (walk_up,) = analyse_recording(replace(recording, devices=(climbing,)), Config())
    lengths = [
        np.array([one.length_m for one in odometry if isinstance(one, StepOdometry)])
        for odometry in (walk_up.odometry, walk_up.whole_walk_odometry)
    ]
    assert lengths[0].min() > 0.4
    assert (lengths[1] < 0.35).sum() >= 5
    assert lengths[1].sum() < lengths[0].sum() - 2.0


@pytest.mark.parametrize("scale_mps", [3.0, 30.0, 3000.0])
def test_vertical_motion_that_nobody_has_gives_probabilities_all_the_same(scale_mps: float) -> None:
    """Of a wrong unit or turned axes: hypotheses become impossible, which is no reason to fail."""
    steps = 60
    jumps = np.random.default_rng(1).normal(0.0, scale_mps, steps).cumsum()
    extra_mps = np.interp(np.arange(steps * COUNT), np.arange(steps) * COUNT, jumps)
    found = probabilities(walk([LEVEL] * steps, extra_mps=extra_mps))
    assert ((found >= 0.0) & (found <= 1.0 + 1e-9)).all()
