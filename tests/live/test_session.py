"""A live walk: what is recorded, what is tracked, what is missing in words, and its limits."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from live_walks import ended, motion_rows, pushed_text
from two_phones import KNOWN_START, recorded

from pdr_est.errors import OutputError, RecordingError
from pdr_est.io.formats.registry import read
from pdr_est.io.side_tables.position_fixes import read_position_fixes
from pdr_est.live.receivers.browser_phone import BrowserPhone
from pdr_est.live.receivers.pushed import PushedMessages
from pdr_est.live.recording_files import LiveRecording
from pdr_est.live.replaying import replay_into
from pdr_est.live.session import LiveSession, Message
from pdr_est.pipeline import smooth_recording
from pdr_est.types.sensors import Channel, SensorBlock

NewWalk = Callable[..., LiveSession]
ALL = ("gravity", "accelerometer", "gyroscope")
FOREVER = {"samples_per_s": 1e6}


def poses_of(messages: list[Message], device: str) -> dict[float, list[float]]:
    """The last pose of a device at each time."""
    rows = [row for message in messages if message["type"] == "poses" for row in message["poses"]]
    latest = {row[1]: row[3:5] for row in rows if row[0] == device}
    return dict(sorted(latest.items()))


def test_the_recording_holds_the_samples_to_the_last_bit(new_walk: NewWalk, tmp_path: Path) -> None:
    recording = recorded(2)
    session = new_walk(tmp_path / "walk", **FOREVER)
    session.start()
    replay_into(session, recording, [], 1000.0)
    assert session.ended.wait(60.0)
    for device in recording.devices:
        again = read(tmp_path / "walk" / f"{device.name}.csv").devices[0]
        for name, signal in device.signals().items():
            np.testing.assert_array_equal(again.signals()[name].time_s, signal.time_s)
            np.testing.assert_array_equal(again.signals()[name].values, signal.values)


@pytest.mark.slow
def test_two_phones_are_one_walker_as_in_a_whole_recording(new_walk: NewWalk, tmp_path: Path) -> None:
    recording, messages = recorded(2), []
    session = new_walk(tmp_path / "walk", KNOWN_START, **FOREVER)
    session.listen(messages.append)
    session.start()
    replay_into(session, recording, [], 1000.0)
    assert session.ended.wait(60.0)
    track = smooth_recording(recording, KNOWN_START).track
    for device in recording.devices:
        found, one = poses_of(messages, device.name), track.of_device(device.name)
        np.testing.assert_allclose(list(found), one.time_s, atol=1e-6)
        np.testing.assert_allclose(list(found.values()), one.position_m, atol=1e-4)
    assert len(poses_of(messages, "fused")) > 60


def test_samples_are_in_the_file_as_soon_as_they_are_taken(new_walk: NewWalk, tmp_path: Path) -> None:
    session = new_walk(tmp_path / "walk")  # whose filter has not even begun
    phone = session.join("browser")
    block = SensorBlock(Channel.ROTATION_RATE, np.array([0.5]), np.array([[0.1, 0.2, 1 / 3]]))
    session.take(phone, [block])
    last = (tmp_path / "walk" / "phone.csv").read_text(encoding="utf-8").splitlines()[-1]
    assert last.startswith("0.5,,,,0.1,0.2,0.3333333333333333,")


def test_a_folder_that_exists_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="exists already"):
        LiveRecording(tmp_path)


def test_a_stated_position_is_recorded_and_moves_the_track(new_walk: NewWalk, tmp_path: Path) -> None:
    device, messages = recorded(1).devices[0], []
    session = new_walk(tmp_path / "walk", KNOWN_START, **FOREVER)
    session.listen(messages.append)
    session.start()
    phone = BrowserPhone(session, session.join("browser"))
    begin_s = session.now_s - 41.0
    phone.take({"rows": motion_rows(device, begin_s, -1.0, 25.0)})
    session.take_fix(5.0, 0.25, 0.1, begin_s + 8.0)
    phone.take({"rows": motion_rows(device, begin_s, 25.0, 40.0)})
    ended(session)
    again = read(tmp_path / "walk" / "phone.csv")
    (fix,) = read_position_fixes(tmp_path / "walk" / "fixes.csv", again)
    assert (fix.time_s, *fix.position_m, fix.source, fix.robust) == (begin_s + 8.0, 5.0, 0.25, "user", True)
    whole = smooth_recording(again, KNOWN_START, [fix]).track
    found = poses_of(messages, "phone")
    np.testing.assert_allclose(list(found.values()), whole.position_m, atol=1e-3)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ((np.nan, 0.0, 1.0, 0.0), "finite"),
        ((0.0, 0.0, 1e-9, 0.0), "standard deviation"),
        ((1e9, 0.0, 1.0, 0.0), "finite"),
    ],
)
def test_impossible_positions_are_refused(new_walk: NewWalk, values: tuple[float, ...], words: str) -> None:
    with pytest.raises(RecordingError, match=words):
        new_walk(None).take_fix(*values)


@pytest.mark.parametrize(("is_ios", "tells_up"), [(True, True), (True, False), (False, True), (False, False)])
def test_browsers_of_either_sign_give_a_force_that_points_up(
    new_walk: NewWalk, tmp_path: Path, is_ios: bool, tells_up: bool
) -> None:
    session = new_walk(tmp_path / "walk")
    phone = BrowserPhone(session, session.join("browser"))
    sign = -1.0 if is_ios else 1.0
    up = {"up": [0.0, 0.0, 1.0]} if tells_up else {}
    phone.take({"rows": [[session.now_s, 0.0, 0.0, sign * 9.8, 90.0, None, 0.0]], "ios": is_ios, **up})
    (row,) = (tmp_path / "walk" / "phone.csv").read_text(encoding="utf-8").splitlines()[1:]
    assert row.split(",")[3] == "9.8"  # and no row for the gyroscope, one of whose axes is unknown


def test_a_wrong_platform_gives_way_to_the_orientation(new_walk: NewWalk, tmp_path: Path) -> None:
    session = new_walk(tmp_path / "walk")
    phone = BrowserPhone(session, session.join("browser"))
    phone.take({"rows": [[session.now_s, 0.0, 0.0, 9.8, 0.0, 0.0, 0.0]], "ios": True, "up": [0.0, 0.0, 1.0]})
    assert (tmp_path / "walk" / "phone.csv").read_text(encoding="utf-8").splitlines()[1].split(",")[3] == "9.8"


def test_what_a_page_sends_twice_counts_once(new_walk: NewWalk, tmp_path: Path) -> None:
    session = new_walk(tmp_path / "walk")
    phone, now_s = BrowserPhone(session, session.join("browser")), session.now_s
    rows = [[now_s + 0.01 * i, 0.0, 0.0, 9.8, 0.0, 0.0, 0.0] for i in range(5)]
    phone.take({"rows": rows[:3]})
    phone.take({"rows": rows})
    assert len((tmp_path / "walk" / "phone.csv").read_text(encoding="utf-8").splitlines()) == 1 + 2 * 5


@pytest.mark.parametrize(
    "rows",
    [
        None,
        "x",
        [1.0],
        [[1.0] * 6],
        [["a"] * 7],
        [[None] * 7],
        [[1e6, *[0.0] * 6]],
        [[-1e6, *[0.0] * 6]],
        [[10**400] * 7],
    ],
)
def test_damaged_rows_are_refused(new_walk: NewWalk, rows: object) -> None:
    session = new_walk(None)
    with pytest.raises(RecordingError, match="load the page again"):
        BrowserPhone(session, session.join("browser")).take({"rows": rows})


def test_the_limits_hold(new_walk: NewWalk) -> None:
    session = new_walk(None, phones=2, samples_per_s=10.0, burst_s=1.0)
    phone = session.join("browser")
    session.join("browser")
    with pytest.raises(RecordingError, match="no more than 2 phones"):
        session.join("browser")
    many = np.zeros(11)
    with pytest.raises(RecordingError, match="more than 10 samples a second"):
        session.take(phone, [SensorBlock(Channel.PRESSURE, many, many[:, None])])


def test_a_recording_that_grows_too_large_ends_the_walk(new_walk: NewWalk, tmp_path: Path) -> None:
    session = new_walk(tmp_path / "walk", walk_bytes=1000)
    session.start()
    times = np.arange(100.0)
    session.take(session.join("browser"), [SensorBlock(Channel.PRESSURE, times, times[:, None])])
    assert session.ended.wait(30.0)


@pytest.mark.parametrize(
    ("sensors", "words"),
    [
        (("accelerometer", "gyroscope"), "no gravity arrives: switch on Gravity in Sensor Logger"),
        (("gravity", "gyroscope"), "no accelerometer arrives: switch on Accelerometer in Sensor Logger"),
        (("gravity", "accelerometer"), "no gyroscope arrives: switch it on in Sensor Logger"),
        (ALL, None),
    ],
)
def test_what_is_missing_is_told_in_words(
    new_walk: NewWalk, sensors: tuple[str, ...], words: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = new_walk(None)
    pushed, zero_s = PushedMessages(session), session.epoch_s
    now = {"s": 0.0}
    monkeypatch.setattr(LiveSession, "now_s", property(lambda _: now["s"]))
    assert "no phone yet" in session.status()["missing"][0]
    for number in range(6):
        now["s"] = number + 1.0
        pushed.take(pushed_text(sensors, number, time_s=zero_s + now["s"]))
    missing = session.status()["missing"]
    assert missing == [] if words is None else words in " ".join(missing)
    now["s"] += 20.0
    assert "nothing has arrived for 20 s" in session.status()["missing"][0]


def test_a_slow_sensor_is_told(new_walk: NewWalk, monkeypatch: pytest.MonkeyPatch) -> None:
    session = new_walk(None)
    phone, now = session.join("browser"), {"s": 0.0}
    monkeypatch.setattr(LiveSession, "now_s", property(lambda _: now["s"]))
    for i in range(60):
        now["s"] = 0.1 * i
        times, values = np.array([now["s"]]), np.zeros((1, 3))
        session.take(phone, [SensorBlock(c, times, values) for c in (Channel.SPECIFIC_FORCE, Channel.ROTATION_RATE)])
    status = session.status()
    assert "sends 10 samples a second: choose at least 50" in status["missing"][0]
    assert status["phones"][0]["sensors"][0]["rate_hz"] == pytest.approx(10.0, abs=0.5)


def test_a_phone_with_a_wrong_clock_is_placed_by_its_arrival(new_walk: NewWalk, tmp_path: Path) -> None:
    session, notes = new_walk(tmp_path / "walk"), []
    session.listen(notes.append)
    pushed = PushedMessages(session)
    for number in range(4):
        pushed.take(
            pushed_text(("gravity", "accelerometer", "gyroscope"), number, time_s=session.epoch_s + 3600.0 + number)
        )
    assert any("its clock is +3600 s off" in str(note) for note in notes)
    times = read(tmp_path / "walk" / "phone.csv").devices[0].rotation_rate
    assert times is not None
    assert times.time_s[0] == pytest.approx(session.now_s - 1.0, abs=5.0)


def test_what_waits_for_a_missing_message_is_tracked_at_the_end(new_walk: NewWalk, tmp_path: Path) -> None:
    session = new_walk(tmp_path / "walk")
    session.start()
    pushed = PushedMessages(session)
    for number in (0, 2):  # 1 never comes
        pushed.take(pushed_text(ALL, number, time_s=session.epoch_s + number))
    ended(session)
    rate = read(tmp_path / "walk" / "phone.csv").devices[0].rotation_rate
    assert rate is not None
    assert len(rate) == 200


def test_a_page_that_opens_later_gets_every_pose_so_far(new_walk: NewWalk) -> None:
    messages: list[Message] = []
    session = new_walk(None, KNOWN_START, **FOREVER)
    session.listen(messages.append)
    session.start()
    replay_into(session, recorded(2), [], 1000.0)
    assert session.ended.wait(60.0)
    later = session.listen(messages.append)
    for device in ("left", "right", "fused"):
        assert poses_of(later, device) == poses_of(messages, device)


def test_every_message_of_an_app_is_kept_as_it_came(new_walk: NewWalk, tmp_path: Path) -> None:
    session = new_walk(tmp_path / "walk")
    pushed = PushedMessages(session)
    texts = [pushed_text(("accelerometer",), number) for number in (0, 2, 1)]
    for text in texts:
        pushed.take(text)
    assert (tmp_path / "walk" / "messages.jsonl").read_text(encoding="utf-8").splitlines() == texts
