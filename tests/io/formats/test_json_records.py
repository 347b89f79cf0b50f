"""JSON of any recorder: lists of records, a record a line, messages, sensors apart, lists of columns."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from table_walk import TableWalk, table_walk

from pdr_est.errors import RecordingError
from pdr_est.io import read
from pdr_est.io.formats.map_draft import write_map_draft
from pdr_est.io.tables.mapping_file import load_mapping

START_MS = 1_927_000_000_123
Record = dict[str, Any]


def times_ms(walk: TableWalk) -> list[int]:
    return [START_MS + round(float(t) * 1e3) for t in walk.time_s]


def sensor(walk: TableWalk, values: Any) -> list[Record]:
    return [
        {"t": t, **dict(zip("xyz", row, strict=True))} for t, row in zip(times_ms(walk), values.tolist(), strict=True)
    ]


def nested(walk: TableWalk) -> list[Record]:
    return [
        {
            "timestamp": t,
            "acc": dict(zip("xyz", f, strict=True)),
            "gyro": dict(zip("xyz", w, strict=True)),
            "tag": None,
        }
        for t, f, w in zip(times_ms(walk), walk.force.tolist(), walk.rate.tolist(), strict=True)
    ]


def vectors(walk: TableWalk) -> list[Record]:
    rows = zip(times_ms(walk), walk.force.tolist(), walk.rate.tolist(), strict=True)
    return [{"t": t, "accelerometer": f, "gyroscope": w} for t, f, w in rows]


def readings(walk: TableWalk) -> list[Record]:
    return [
        {"sensor": name, "time": t, "values": row}
        for name, values in (("accelerometer", walk.force), ("gyroscope", walk.rate))
        for t, row in zip(times_ms(walk), values.tolist(), strict=True)
    ]


def messages(walk: TableWalk) -> list[Record]:
    found = readings(walk)
    return [{"session": "a", "payload": found[i : i + 100]} for i in range(0, len(found), 100)]


def columns(walk: TableWalk) -> Record:
    axes = {f"a{name}": walk.force[:, i].tolist() for i, name in enumerate("xyz")}
    axes |= {f"w{name}": walk.rate[:, i].tolist() for i, name in enumerate("xyz")}
    return {"device": "phone", "time": times_ms(walk), **axes}


def sensors(walk: TableWalk) -> Record:
    return {"accelerometer": sensor(walk, walk.force), "gyroscope": sensor(walk, walk.rate)}


def texts_of_numbers(walk: TableWalk) -> list[Record]:
    return [{name: str(value) for name, value in one.items()} for one in _flat(walk)]


def _flat(walk: TableWalk) -> list[Record]:
    names = ("time", "accX", "accY", "accZ", "gyroX", "gyroY", "gyroZ")
    rows = zip(times_ms(walk), walk.force.tolist(), walk.rate.tolist(), strict=True)
    return [dict(zip(names, (t, *f, *w), strict=True)) for t, f, w in rows]


def lines(records: list[Record]) -> str:
    return "\n".join(map(json.dumps, records))


LAYOUTS: dict[str, Callable[[TableWalk], str]] = {
    "records in records": lambda walk: json.dumps(nested(walk)),
    "records below another name": lambda walk: json.dumps({"meta": {"app": "mine"}, "data": nested(walk)}),
    "vectors": lambda walk: json.dumps(vectors(walk)),
    "a record a line": lambda walk: lines(nested(walk)),
    "readings of all sensors": lambda walk: json.dumps(readings(walk)),
    "messages with readings": lambda walk: lines(messages(walk)),
    "lists of columns": lambda walk: json.dumps(columns(walk)),
    "a list a sensor": lambda walk: json.dumps(sensors(walk), indent=1),
    "numbers as texts": lambda walk: json.dumps(texts_of_numbers(walk)),
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_the_walk_is_read_whatever_the_layout(name: str, tmp_path: Path) -> None:
    walk = table_walk()
    path = tmp_path / "walk.json"
    path.write_text(LAYOUTS[name](walk), encoding="utf-8")
    recording = read(path)
    device = recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate)
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=1e-6)
    assert recording.epoch_s == pytest.approx(START_MS / 1e3)


def test_a_last_line_that_is_cut_is_left_out(tmp_path: Path) -> None:
    walk = table_walk()
    path = tmp_path / "walk.json"
    path.write_text(lines(nested(walk))[:-20], encoding="utf-8")
    force = read(path).devices[0].specific_force
    assert force is not None
    assert len(force) == len(walk.time_s) - 1


def test_a_draft_of_a_mapping_reads_the_same_samples(tmp_path: Path) -> None:
    path = tmp_path / "walk.json"
    path.write_text(json.dumps(nested(table_walk())), encoding="utf-8")
    write_map_draft(path, tmp_path / "map.yaml")
    mapped = read(path, load_mapping(tmp_path / "map.yaml")).devices[0].specific_force
    plain = read(path).devices[0].specific_force
    assert plain is not None
    assert mapped is not None
    np.testing.assert_array_equal(mapped.values, plain.values)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[{"t": 1, "ax": 2}, {"t"', "line 1: damaged or truncated JSON"),
        ('{"t": 1}\nnonsense\n{"t": 2}\n', "line 2: damaged JSON"),
        ('{"name": "walk"}', "JSON without records"),
        ("[" * 5000, "unknown format"),
        ("[hello] to all\nof you\n", "or text in brackets"),
    ],
)
def test_other_json_is_refused_with_words(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "walk.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RecordingError, match=message):
        read(path)
