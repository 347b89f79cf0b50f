"""Tables of clock messages: read whole, and refused with the line and the value."""

from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.io import read
from pdr_est.io.side_tables.clock_messages import read_clock_messages

HEADER = "device,t1_s,t2_s,t3_s"


def saved(folder: Path, *lines: str, name: str = "messages.csv") -> Path:
    path = folder / name
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_a_table_is_read_whole(tmp_path: Path) -> None:
    messages = read_clock_messages(saved(tmp_path, HEADER, "b,1.0,3.5,1.1", " c ,2.0,9.5,2.2"))
    assert messages.device == ("b", "c")
    np.testing.assert_array_equal([messages.t1_s, messages.t2_s, messages.t3_s], [[1.0, 2.0], [3.5, 9.5], [1.1, 2.2]])


def test_other_spellings_are_understood(tmp_path: Path) -> None:
    messages = read_clock_messages(saved(tmp_path, "T1_s;T3_s;Device;T2_s;note", "1,0;1,1;7;3,5;hello"))
    assert messages.device == ("7",)
    assert (messages.t1_s[0], messages.t2_s[0], messages.t3_s[0]) == (1.0, 3.5, 1.1)


@pytest.mark.parametrize(
    ("lines", "pattern"),
    [
        (("device,t1_s,t3_s", "b,1,2"), "no column t2_s among device, t1_s, t3_s: name the columns"),
        ((HEADER,), "contains no exchange: add a row"),
        (("7",), "no header line device,t1_s"),
        ((HEADER, "b,1.0,3.5,1.1", "b,x,3.5,1.1"), "line 3, column 't1_s': 'x' is not a number"),
        ((HEADER, "b,1.0,,1.1"), "line 2: t2_s = nan: give a number"),
        ((HEADER, "b,1.0,3.5,1.1", "b,1.0,3.5,inf"), "line 3: t3_s = nan: give a number"),
        ((HEADER, "b,1.2,3.5,1.1"), "line 2: t3_s = 1.100000 is before t1_s = 1.200000.*exchanged"),
        ((HEADER, "b,1718030736000,3.5,1718030736001"), r"line 2: t1_s = 1.71803e\+12 is not a time in seconds"),
        ((HEADER, ",1.0,3.5,1.1"), "line 2: no device name: name the device"),
        ((HEADER, "b,1.0,3.5"), "line 2: 3 fields instead of 4"),
    ],
)
def test_bad_tables_are_refused(lines: tuple[str, ...], pattern: str, tmp_path: Path) -> None:
    path = saved(tmp_path, *lines)
    with pytest.raises(RecordingError, match=pattern) as refusal:
        read_clock_messages(path)
    assert str(refusal.value).startswith(str(path))


def test_a_folder_of_several_files_is_no_table(tmp_path: Path) -> None:
    saved(tmp_path, HEADER, "b,1.0,3.5,1.1")
    saved(tmp_path, HEADER, "b,1.0,3.5,1.1", name="more.csv")
    with pytest.raises(RecordingError, match="contains 2 files"):
        read_clock_messages(tmp_path)


def test_messages_in_the_folder_of_a_recording_come_with_it(tmp_path: Path) -> None:
    rows = [f"{t:.2f},0,0,9.81,0,0,0" for t in np.arange(0.0, 2.0, 0.02)]
    titles = "time_s,acc_x_mps2,acc_y_mps2,acc_z_mps2,gyr_x_radps,gyr_y_radps,gyr_z_radps"
    saved(tmp_path, titles, *rows, name="a.csv")
    assert read(tmp_path).messages == ()
    saved(tmp_path, HEADER, "b,1.0,3.5,1.1", name="clock_messages.csv")
    (messages,) = read(tmp_path).messages
    assert messages.device == ("b",)
    assert messages.place == str(tmp_path / "clock_messages.csv")
