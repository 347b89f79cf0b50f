"""The devices of a recording on one clock: by messages, as given, as recorded, and not at all."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from pdr_est.clock_sync import ClockMethod, GivenClock, align_device_clocks
from pdr_est.errors import ConfigError, RecordingError
from pdr_est.preprocessing.merge import merge_recordings
from pdr_est.simulate import (
    DeviceParams,
    HeldPhone,
    PathParams,
    PocketPhone,
    Scenario,
    WalkerGaitParams,
    simulate_walk,
)
from pdr_est.types.recording import ClockMessages, DeviceRecording, Recording, Signal

TIMES_S = np.linspace(0.0, 100.0, 11)
EPOCH_S = 1.7e9


def device(name: str, offset_s: float = 0.0, skew: float = 0.0) -> DeviceRecording:
    times_s = (1.0 + skew) * TIMES_S + offset_s
    return DeviceRecording(name, specific_force=Signal(times_s, np.full((11, 3), offset_s)))


def recorded(*devices: DeviceRecording, messages: Sequence[ClockMessages] = ()) -> Recording:
    return Recording("walk", "made up", devices, messages=tuple(messages))


def exchanged(
    name: str, offset_s: float, skew: float = 0.0, asked_at_s: float = 0.0, delay_s: float = 0.01
) -> ClockMessages:
    """An exchange a minute, both ways of which take delay_s."""
    t1_s = np.arange(0.0, 300.0, 60.0)
    t2_s = (1.0 + skew) * (t1_s + delay_s) + offset_s
    return ClockMessages("file", (name,) * 5, t1_s + asked_at_s, t2_s, t1_s + 2.0 * delay_s + asked_at_s)


def times_of(moved: DeviceRecording) -> np.ndarray:
    assert moved.specific_force is not None
    return moved.specific_force.time_s


def test_messages_bring_every_device_onto_the_first_clock() -> None:
    devices = (device("a"), device("b", 7.0, 5e-5), device("c", -3600.0))
    messages = [exchanged("b", 7.0, 5e-5), exchanged("c", -3600.0)]
    (_, none), *others = align_device_clocks(recorded(*devices, messages=messages), "messages")
    assert none is None
    for moved, clock in others:
        np.testing.assert_allclose(times_of(moved), TIMES_S, atol=1e-3)
        assert clock is not None
        assert (clock.method, clock.used, clock.doubts) == ("messages", True, ())


def test_stamps_may_be_those_of_the_recordings_or_of_the_date() -> None:
    """Recordings that begin 40 s apart by dates, the second clock 2 s ahead; stamps on their own zeros, then Unix."""
    one = replace(recorded(device("a")), name="one", epoch_s=EPOCH_S)
    two = replace(recorded(device("b", 0.0)), name="two", epoch_s=EPOCH_S + 40.0)
    own = ClockMessages("own", ("b",), np.array([50.0]), np.array([12.01]), np.array([50.02]))
    dated = ClockMessages("dated", ("b",), own.t1_s + EPOCH_S, own.t2_s + EPOCH_S + 40.0, own.t3_s + EPOCH_S)
    for messages in (own, dated):
        both = replace(merge_recordings([one, two]), messages=(messages,))
        _, (moved, clock) = align_device_clocks(both, "messages")
        assert clock is not None
        assert clock.offset_s == pytest.approx(2.0, abs=1e-5)
        np.testing.assert_allclose(times_of(moved), TIMES_S + 38.0, atol=1e-4)


def test_recordings_bring_their_messages_together() -> None:
    own = exchanged("two", 0.0)
    one, two = (replace(recorded(device("phone", k)), name=name) for k, name in enumerate(("one", "two")))
    assert merge_recordings([replace(one, messages=(own,)), two]).messages == (own,)


def test_messages_long_before_the_walk_are_poor_but_used() -> None:
    early = ClockMessages("file", ("b",), *(np.array([stamp_s - 3600.0]) for stamp_s in (0.0, 7.01, 0.02)))
    _, (moved, clock) = align_device_clocks(recorded(device("a"), device("b", 7.0), messages=[early]), "messages")
    assert clock is not None
    assert clock.used
    assert "farthest from the messages" in clock.doubts[0]
    assert moved.warnings == (f"clock: {clock.doubts[0]}",)
    np.testing.assert_allclose(times_of(moved), TIMES_S, atol=1e-3)


def test_messages_of_a_clock_that_jumps_are_doubted() -> None:
    messages = exchanged("b", 7.0)
    jumped = replace(messages, t2_s=messages.t2_s + np.array([0.0, 0.0, 0.0, 1.9, 1.9]))
    _, (_, clock) = align_device_clocks(recorded(device("a"), device("b", 7.0), messages=[jumped]), "messages")
    assert clock is not None
    assert clock.doubts == ("3 of 5 exchanges fit one line: the clock jumps",)


@pytest.mark.parametrize(
    ("messages", "pattern"),
    [
        ([], "the recording has no clock messages: give them with --messages"),
        ([exchanged("a", 0.0)], "file, line 2: device 'a': the devices that answer the first one, 'a', are 'b', 'c'"),
        ([exchanged("b", 0.0)], "file: no message of device 'c'"),
        (
            [exchanged("c", 0.0), exchanged("b", EPOCH_S)],
            r"t2_s = 1700000000.010000 is far from what b recorded",
        ),
        (
            [exchanged("c", 0.0), exchanged("b", 0.0, asked_at_s=1e6)],
            r"2: t1_s = 1000000.* \(0.000 to 100.000 s\)",
        ),
    ],
)
def test_messages_that_do_not_fit_are_refused(messages: list[ClockMessages], pattern: str) -> None:
    with pytest.raises(RecordingError, match=pattern):
        align_device_clocks(recorded(device("a"), device("b"), device("c"), messages=messages), "messages")


def test_messages_need_somebody_to_answer() -> None:
    with pytest.raises(RecordingError, match="there is no other device than 'a': give the other recording too"):
        align_device_clocks(recorded(device("a"), messages=[exchanged("b", 0.0)]), "messages")


def test_given_clocks_are_taken_out_exactly() -> None:
    devices = (device("a", 0.5, 1e-4), device("b", 7.0, -2e-4), device("c"))
    given = [
        GivenClock(device="b", offset_s=7.0, skew_ppm=-200.0, sigma_s=0.03),
        GivenClock(device="a", offset_s=0.5, skew_ppm=100.0, sigma_s=0.04),
    ]
    _, (b, clock), (c, _) = align_device_clocks(recorded(*devices), "given", given)
    first = (1.0 + 1e-4) * TIMES_S + 0.5
    np.testing.assert_allclose(times_of(b), first, atol=1e-9)
    np.testing.assert_allclose(times_of(c), first, atol=1e-9)
    assert clock is not None
    assert (clock.method, clock.sigma_s) == ("given", pytest.approx(0.05))


def test_given_clocks_that_cannot_be_are_refused() -> None:
    both = recorded(device("a"), device("b"))
    with pytest.raises(ConfigError, match="the recording has no device 'x'; its devices are a, b"):
        align_device_clocks(both, "given", [GivenClock(device="x", offset_s=1.0)])
    with pytest.raises(ConfigError, match="'b' is given twice"):
        align_device_clocks(
            both, "given", [GivenClock(device="b", offset_s=1.0), GivenClock(device="b", offset_s=2.0)]
        )
    with pytest.raises(ConfigError, match="no clock is given"):
        align_device_clocks(both, "given")


def test_without_a_method_times_stay_as_they_are() -> None:
    both = recorded(device("a"), device("b", 4.0))
    assert align_device_clocks(both, "none") == [(both.devices[0], None), (both.devices[1], None)]


def walked(seed: int, cadence_hz: float) -> tuple[DeviceRecording, DeviceRecording]:
    scenario = Scenario(
        path=PathParams(vertices_m=((0.0, 0.0), (40.0, 0.0), (40.0, 20.0))),
        gait=WalkerGaitParams(cadence_hz=cadence_hz),
        devices=(DeviceParams(name="hand", carry=HeldPhone()), DeviceParams(name="pocket", carry=PocketPhone())),
        seed=seed,
    )
    hand, pocket = simulate_walk(scenario).recording.devices
    return hand, pocket


@pytest.mark.parametrize("late_s", [0.0, 3600.0])
def test_walks_of_two_people_are_refused_wherever_their_clocks_are(late_s: float) -> None:
    """On one route, at nearly the same pace."""
    (hand, _), (_, stranger) = walked(1, 1.8), walked(2, 1.85)
    with pytest.raises(
        RecordingError, match=r"hand and pocket: no shift of the clocks makes their steps coincide.*one by one"
    ):
        align_device_clocks(recorded(hand, stranger.with_times(lambda time_s: time_s + late_s)))


def test_a_clock_that_jumps_by_seconds_is_still_of_one_walk() -> None:
    hand, pocket = walked(1, 1.8)
    middle_s = float(times_of(pocket).mean())
    jumped = pocket.with_times(lambda time_s: time_s + np.where(time_s < middle_s, 0.0, 3.3))
    _, (_, clock) = align_device_clocks(recorded(hand, jumped))
    assert clock is not None
    an_hour_late = jumped.with_times(lambda time_s: time_s + 3600.0)
    with pytest.raises(RecordingError, match="less than 5 s of it together"):  # one walk, but nobody knows how
        align_device_clocks(recorded(hand, an_hour_late))


@pytest.mark.parametrize("method", ["none", "given", "messages"])
@pytest.mark.parametrize("late_s", [97.0, 3600.0])
def test_devices_that_hardly_recorded_together_are_refused(method: ClockMethod, late_s: float) -> None:
    messages = [exchanged(name, 0.0) for name in "bc"]
    apart = recorded(device("a"), device("b", -50.0), device("c", late_s), messages=messages)
    given = [GivenClock(device="a", offset_s=0.0)] if method == "given" else []
    pattern = rf"c recorded from {late_s} to .* less than 5 s of it .* \(a from 0\.0 to 100\.0 s, b .* one by one"
    with pytest.raises(RecordingError, match=pattern):
        align_device_clocks(apart, method, given)


def test_devices_that_begin_late_or_end_early_are_told() -> None:
    (a, _), (b, _), (c, _) = align_device_clocks(recorded(device("a"), device("b", 50.0), device("c", 120.0)), "none")
    assert [len(moved.warnings) for moved in (a, b, c)] == [1, 2, 1]
    assert a.warnings[0].startswith("ended 120.0 s before another device, whose track is the person's")
    assert c.warnings[0].startswith("began to record 120.0 s after another device, whose track is the person's")
    (a, _), (b, _) = align_device_clocks(recorded(device("a"), device("b", 4.0)), "none")
    assert (a.warnings, b.warnings) == ((), ())


def test_two_short_recordings_may_be_together() -> None:
    short = [device(name).with_times(lambda time_s: 0.03 * time_s) for name in "ab"]
    assert len(align_device_clocks(recorded(*short), "none")) == 2


def test_a_device_left_on_a_table_is_only_doubted() -> None:
    hand, pocket = walked(1, 1.8)
    noise = 0.02 * np.random.default_rng(0).standard_normal((len(times_of(pocket)), 3))
    still = replace(pocket, specific_force=Signal(times_of(pocket), np.array([0.0, 0.0, 9.81]) + noise))
    _, (left, _) = align_device_clocks(recorded(hand, still))
    assert any("clock taken as recorded" in warning for warning in left.warnings)
