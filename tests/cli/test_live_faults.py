"""Faults in what a phone sends are told a few times, and neither stop the walk nor change estimates of others."""

import io
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from cli_recordings import Walk
from click.testing import CliRunner

from pdr_est.cli import main
from pdr_est.cli.work.bounded_notes import bounded_lines
from pdr_est.errors import RecordingError
from pdr_est.io.formats.phone_apps.sensor_logger.live import LiveReader
from pdr_est.io.formats.phone_apps.sensor_logger.live_messages import LONGEST_LINE

ZERO_NS = 1_698_501_144_000_000_000
Message = dict[str, Any]


def messages(walk: Walk, device: str = "phone") -> list[Message]:
    """A walk as an Android phone would send it, a second at a time."""
    time_s, found = walk.time_s, []
    for number in range(int(time_s[-1]) + 1):
        payload = []
        for i in np.flatnonzero((time_s >= number) & (time_s < number + 1)):
            stamp = ZERO_NS + round(float(time_s[i]) * 1e9)
            for name, cells in (("totalacceleration", walk.force[i]), ("gyroscope", walk.rate[i])):
                payload.append({"name": name, "time": stamp, "values": dict(zip("xyz", cells, strict=True))})
        found.append({"messageId": number, "sessionId": "s", "deviceId": device, "payload": payload})
    return found


def live(content: bytes) -> Any:
    return CliRunner().invoke(
        main, ["track", "-", "--platform", "android"], input=io.BytesIO(content), prog_name="pdr-est"
    )


def tracked(content: bytes, device: str = "phone") -> tuple[list[Message], str]:
    """The last estimate of each pose of a device, and what was told."""
    result = live(content)
    assert result.exit_code == 0, result.output
    rows = [row for row in map(json.loads, result.stdout.splitlines()) if row["device"] == device]
    return list({row["time_s"]: row for row in rows}.values()), result.stderr


def encoded(found: list[Message]) -> bytes:
    return b"".join(json.dumps(message).encode() + b"\n" for message in found)


def shift_reading(found: list[Message], by_s: float) -> None:
    found[3]["payload"][20]["time"] += round(by_s * 1e9)


def shift_message(found: list[Message], by_s: float) -> None:
    for reading in found[3]["payload"]:
        reading["time"] += round(by_s * 1e9)


def renumber(found: list[Message], number: int) -> None:
    found[3]["messageId"] = number


FAULTS: dict[str, tuple[Callable[[list[Message]], Any], str]] = {
    "future": (lambda found: shift_reading(found, 1000.0), "with a stray time"),
    "far future": (lambda found: shift_reading(found, 1e9), "with a stray time"),
    "past": (lambda found: shift_reading(found, -1000.0), "with a stray time"),
    "future message": (lambda found: shift_message(found, 1e6), "has a stray time"),
    "past message": (lambda found: shift_message(found, -1e6), "has a stray time"),
    "number": (lambda found: renumber(found, 10**18), "has a number far from the one before"),
    "negative number": (lambda found: renumber(found, -(10**18)), "came after later ones"),
    "doubled": (lambda found: found.insert(4, found[3]), "came after later ones"),
    "nan": (lambda found: found[3]["payload"][20]["values"].update(x=float("nan")), ""),
    "inf": (lambda found: found[3]["payload"][21]["values"].update(y=float("-inf")), ""),
}
LINES = {
    "no UTF-8": b'{"deviceId": "\xff\xfe", "payload": 3}\n',
    "nested": b"[" * 100_000 + b"\n",
    "nul": b"\0\0\n",
    "a name that is none": b'{"deviceId": {"a": [1, 2]}, "payload": []}\n',
    "a name that is long": b'{"deviceId": "' + b"x" * 1000 + b'", "payload": []}\n',
    "a number that is long": b'{"payload": [{"name": "gyroscope", "time": ' + b"9" * 5000 + b', "values": {}}]}\n',
    "too long": b'{"payload": [' + b"1," * (LONGEST_LINE // 2) + b"1]}\n",
}


@pytest.fixture(scope="module")
def undisturbed(walk: Walk) -> list[Message]:
    return tracked(encoded(messages(walk)))[0]


def assert_alike(found: list[Message], expected: list[Message], at_most_lost: int) -> None:
    assert len(found) >= len(expected) - at_most_lost
    assert found[-1]["time_s"] == pytest.approx(expected[-1]["time_s"], abs=0.1)
    assert all(np.isfinite([row["x_m"], row["y_m"], row["cov_xx_m2"]]).all() for row in found)


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_in_one_message_costs_that_message(fault: str, walk: Walk, undisturbed: list[Message]) -> None:
    found = messages(walk)
    change, words = FAULTS[fault]
    change(found)
    rows, told = tracked(encoded(found))
    assert words in told
    assert told.count("\n") <= 4
    assert_alike(rows, undisturbed, at_most_lost=3)


@pytest.mark.parametrize("line", LINES)
def test_a_line_that_is_no_message_costs_nothing(line: str, walk: Walk, undisturbed: list[Message]) -> None:
    found = [encoded([message]) for message in messages(walk)]
    rows, told = tracked(b"".join([*found[:3], LINES[line], *found[3:]]))
    assert rows == undisturbed
    assert "line 4: " in told
    assert told.count("\n") == 1
    assert len(told) < 600


def test_a_restarted_phone_counts_anew(walk: Walk, undisturbed: list[Message]) -> None:
    found = messages(walk)
    for number, message in enumerate(found[4:]):
        message["messageId"] = number
    rows, told = tracked(encoded(found))
    assert told.count("came after later ones") == 1
    assert_alike(rows, undisturbed, at_most_lost=3)


def test_a_gap_is_no_stray_time(walk: Walk) -> None:
    found = messages(walk)
    for message in found[4:]:
        for reading in message["payload"]:
            reading["time"] += 500_000_000_000
    rows, told = tracked(encoded(found))
    assert "stray" not in told
    assert rows[-1]["time_s"] > 500.0


def test_a_phone_that_is_called_as_the_person_gets_another_name(walk: Walk, undisturbed: list[Message]) -> None:
    rows, told = tracked(encoded(messages(walk, "fused")), "fused (phone)")
    assert told == "warning: fused: the person is called that: this phone is called fused (phone)\n"
    assert [row["x_m"] for row in rows] == [row["x_m"] for row in undisturbed]


def test_warnings_of_a_kind_do_not_repeat_for_ever(walk: Walk, undisturbed: list[Message]) -> None:
    found = encoded(messages(walk))
    rows, told = tracked(found + b"junk\n" * 2000)
    assert rows == undisturbed
    assert told.count("\n") == 6  # three, the tenth, the hundredth and the thousandth


def test_names_without_end_take_no_memory(walk: Walk, undisturbed: list[Message]) -> None:
    """Each would cost some megabytes, as the state of a phone."""
    found = messages(walk)
    strangers = [{**found[i % len(found)], "deviceId": f"p{i}"} for i in range(200)]
    rows, told = tracked(encoded([found[0], *strangers, *found[1:]]))
    assert "one more phone than the 16" in told
    assert [row["time_s"] for row in rows] == [row["time_s"] for row in undisturbed]
    reader = LiveReader("android")
    for message in strangers[:15]:
        reader.push(json.dumps(message))
    reader.push(json.dumps(found[0]))
    with pytest.raises(RecordingError, match="one more phone"):
        reader.push(json.dumps(strangers[15]))


def test_a_long_line_is_never_in_memory_as_a_whole() -> None:
    lines = list(bounded_lines(io.StringIO("ab\n" + "x" * 100 + "\n" + "1234\n" + "12345\nend"), 4))
    assert lines == ["ab\n", "xxxxx", "1234\n", "12345", "end"]
