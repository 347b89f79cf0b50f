"""Messages of Sensor Logger while it records."""

import json
import pickle
from typing import Any

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.frames import GeoOrigin
from pdr_est.io.formats.phone_apps.sensor_logger.live import LiveReader, LiveUpdate, Platform
from pdr_est.types.sensors import Channel

ZERO_NS = 1_698_501_144_401_773_001


def reading(name: str, time_s: float, **values: float) -> dict[str, Any]:
    return {"name": name, "time": ZERO_NS + round(time_s * 1e9), "values": values}


def second(k: int, sign: float = 1.0, extra: tuple[dict[str, Any], ...] = ()) -> list[dict[str, Any]]:
    """One second at 20 Hz of a phone that lies face up, its accelerometer between the samples of gravity."""
    payload = []
    for i in range(20):
        time_s = k + i / 20.0
        payload += [
            reading("gravity", time_s, x=0.0, y=0.0, z=sign * 9.8),
            reading("accelerometer", time_s + 0.01, x=sign * 0.1, y=0.0, z=sign * 0.2),
            reading("gyroscope", time_s, x=0.0, y=0.0, z=0.5),
        ]
    return [*payload, *extra]


def message(number: int, payload: list[dict[str, Any]], device: str = "p") -> str:
    return json.dumps({"messageId": number, "sessionId": "s", "deviceId": device, "payload": payload})


def read(lines: list[str], platform: Platform | None = None) -> LiveUpdate:
    reader = LiveReader(platform)
    news = [*(reader.push(line) for line in lines), reader.flush()]
    return LiveUpdate(
        tuple(block for one in news for block in one.blocks),
        tuple(fix for one in news for fix in one.fixes),
        tuple(note for one in news for note in one.notes),
    )


def joined(news: LiveUpdate, channel: Channel, device: str = "p") -> tuple[np.ndarray, np.ndarray]:
    own = [block for name, block in news.blocks if block.channel == channel and name == device]
    return np.concatenate([block.time_s for block in own]), np.concatenate([block.values for block in own])


@pytest.mark.parametrize(("sign", "platform"), [(1.0, None), (-1.0, None), (1.0, "android"), (-1.0, "ios")])
def test_specific_force_points_up_on_every_phone(sign: float, platform: Platform | None) -> None:
    news = read([message(k, second(k, sign)) for k in range(5)], platform)
    time_s, force = joined(news, Channel.SPECIFIC_FORCE)
    assert len(time_s) == 100
    assert time_s[:2] == pytest.approx([0.01, 0.06], abs=1e-9)
    assert force == pytest.approx(np.tile([0.1, 0.0, 10.0], (100, 1)))
    assert joined(news, Channel.ROTATION_RATE)[1][:, 2] == pytest.approx(0.5)
    assert (len(news.notes) == 0) == (platform is not None)


def test_the_attitude_decides_for_a_phone_that_faces_down() -> None:
    down = [
        [
            *(reading("gravity", k + i / 20.0, x=0.0, y=0.0, z=-9.8) for i in range(20)),
            *(reading("accelerometer", k + i / 20.0, x=0.0, y=0.0, z=0.0) for i in range(20)),
            *(reading("orientation", k + i / 20.0, qw=0.0, qx=1.0, qy=0.0, qz=0.0) for i in range(20)),
        ]
        for k in range(4)
    ]
    _, force = joined(read([message(k, payload) for k, payload in enumerate(down)]), Channel.SPECIFIC_FORCE)
    assert force[:, 2] == pytest.approx(-9.8)


def test_messages_are_put_in_order_and_missing_ones_are_told() -> None:
    lines = [message(k, second(k)) for k in range(20)]
    swapped = [lines[0], lines[2], lines[1], *lines[3:]]
    whole, mixed = read(lines, "android"), read(swapped, "android")
    assert np.array_equal(joined(whole, Channel.SPECIFIC_FORCE)[0], joined(mixed, Channel.SPECIFIC_FORCE)[0])
    assert mixed.notes == ()
    lost = read([*lines[:4], *lines[6:], lines[4]], "android")
    assert lost.notes == (
        "p: 2 messages before message 6 are missing",
        "p: message 4 came after later ones and is left out",
    )
    assert len(joined(lost, Channel.ROTATION_RATE)[0]) == 18 * 20


def test_phones_share_clock_and_map() -> None:
    def here(k: int, latitude: float) -> tuple[dict[str, Any], ...]:
        return (reading("location", k + 0.5, latitude=latitude, longitude=10.0, horizontalAccuracy=4.0),)

    first = message(0, second(0, extra=here(0, 50.0)), "a")
    other = message(0, second(1, extra=here(1, 50.001)), "b")
    news = read([first, other, message(1, second(2, extra=here(2, 50.002)), "a")], "android")
    assert [fix.time_s for fix in news.fixes] == pytest.approx([0.5, 1.5, 2.5])
    assert [fix.position_m[1] for fix in news.fixes] == pytest.approx([0.0, 111.2, 222.4], abs=0.2)
    assert joined(news, Channel.ROTATION_RATE, "b")[0][0] == pytest.approx(1.0)


def test_the_origin_of_the_map_may_be_given() -> None:
    place = reading("location", 0.5, latitude=50.001, longitude=10.0, horizontalAccuracy=4.0)
    news = LiveReader("android", GeoOrigin(50.0, 10.0)).push(message(0, second(0, extra=(place,)), "a"))
    assert [fix.position_m.tolist() for fix in news.fixes] == [pytest.approx([0.0, 111.2], abs=0.2)]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("", "not JSON"),
        ("[1, 2]", "payload is missing"),
        ('{"payload": 3}', "payload is missing"),
        ('{"payload": [{"name": "gyroscope", "time": 1}]}', "reading 1 of the payload is damaged"),
        ('{"payload": [{"name": "gyroscope", "time": -5, "values": {}}]}', "is not a Unix time"),
        ('{"payload": [{"name": "gyroscope", "time": 1, "values": {"x": 1, "y": "a", "z": 2}}]}', "reading 1"),
    ],
)
def test_what_is_no_message_is_refused(line: str, words: str) -> None:
    with pytest.raises(RecordingError, match=words):
        LiveReader().push(line)


@pytest.mark.parametrize(
    ("broken", "words"),
    [
        ({"time": ZERO_NS, "values": {}}, "name is missing"),
        ({"name": "gyroscope", "time": "noon", "values": {}}, r"\(gyroscope\): time is damaged: 'noon' is not a nu"),
        ({"name": "gyroscope", "time": -5, "values": {}}, "time -5 is not a Unix time"),
        ({"name": "gyroscope", "time": ZERO_NS, "values": {"x": 0, "y": 0}}, "the value z is missing"),
        ({"name": "gyroscope", "time": ZERO_NS, "values": {"x": 0, "y": 0, "z": None}}, "z is damaged: None is not"),
        (7, "it is not an object with name, time and values"),
    ],
)
def test_damage_is_told_in_words(broken: Any, words: str) -> None:
    line = message(0, [*second(0), broken])
    with pytest.raises(RecordingError, match=words):
        LiveReader("android").push(line)


def test_acceleration_without_gravity_is_left_out_and_told_once() -> None:
    reader, sizes, notes = LiveReader("android"), [], []
    for k in range(200):
        payload = [one for one in second(k) if one["name"] != "gravity"]
        notes += reader.push(message(k, payload)).notes
        sizes.append(len(pickle.dumps(reader)))
    longest = 61 * 20 * 4 * 8  # 61 s of 20 samples, a time and three values of 8 bytes each
    assert max(sizes) <= longest + 4000
    remedy = "switch on gravity or total acceleration in the app"
    assert notes == [f"p: acceleration without gravity is left out: {remedy}"]
