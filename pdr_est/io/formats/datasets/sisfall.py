"""Read the SisFall data set (Sucerquia et al. 2017): a box at the belt with two accelerometers and a gyroscope.

A file `ACTIVITY_PERSON_TRIAL.txt` has no header: nine integers a row, three of each sensor, at 200 Hz, and ";" at its
end. The ADXL345 accelerometer counts 1/256 g, the ITG3200 gyroscope 4000/65536 deg/s; at rest the acceleration points
up.
"""

import re

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.types.ground_truth import Truth
from pdr_est.types.recording import DeviceRecording, Recording

NAME = "SisFall"

_FORCE = ("ADXL345 x", "ADXL345 y", "ADXL345 z")
_RATE = ("ITG3200 x", "ITG3200 y", "ITG3200 z")
_SECOND_FORCE = ("MMA8451Q x", "MMA8451Q y", "MMA8451Q z")
_COLUMNS = (*_FORCE, *_RATE, *_SECOND_FORCE)
_BITS = ((_FORCE, 13), (_RATE, 16), (_SECOND_FORCE, 14))
_CUT = "the last row has no ';': the file is cut off there and its end is missing"
_RATE_HZ = 200.0
_FORCE_MPS2_PER_BIT = 2 * 16 / 2**13 * STANDARD_GRAVITY_MPS2  # +-16 g in 13 bits
_RATE_RADPS_PER_BIT = np.deg2rad(2 * 2000 / 2**16)  # +-2000 deg/s in 16 bits
_ROW = re.compile(rb"(?:\s*-?\d{1,5}\s*,){8}\s*-?\d{1,5}\s*;\s*")
_FEWEST_ROWS = 2
_FILE_NAME = re.compile(r"([DF]\d\d)_S[AE]\d\d_R\d\d")
ACTIVITIES = {
    "D01": "walking",
    "D02": "walking",
    "D03": "jogging",
    "D04": "running",
    "D05": "stairs",
    "D06": "stairs",
}


def sniff(source: Source) -> bool:
    """Tell whether a member of the source is a table of this data set."""
    return bool(find_members(source, _is_table))


def read_source(source: Source) -> Recording:
    """Read the recording of a SisFall table, with the activity if the name of the file tells it.

    Slow and quick walking (D01, D02) are "walking", slow jogging (D03) is "jogging", quick jogging (D04) "running".
    Slow and quick are what the person took them for: one person's running can be another's jogging. Stairs (D05, D06)
    are "stairs", falls (F01 to F15) "fall"; sitting, lying, bending and jumping have no activity here.

    Time is the row number at 200 Hz. A file that ends within the last number of a row has a warning.

    Raises
    ------
    RecordingError
        When there are several recordings, the table is damaged or a number is beyond the range of its sensor.
    """
    member = require_single_walk(source, find_members(source, _is_table), NAME)
    # A blank and not nothing, so that a ";" within a row does not join two numbers into one.
    rows = source.read(member).replace(b";", b" ")
    table = read_table(rows, source.place(member), has_header=False, columns=_COLUMNS)
    _check_bits(table)
    name = member_stem(member)
    cut_warning = () if source.read(member).rstrip().endswith(b";") else (_CUT,)
    return Recording(
        name=name, format=NAME, devices=(_device(table, cut_warning),), truth=Truth(activity=_activity(name))
    )


def _is_table(head: bytes) -> bool:
    """Look for rows of nine integers with a ";" at the end; the last line of the head may be cut."""
    rows = [line for line in head.splitlines()[:-1] if line.strip()]
    return len(rows) >= _FEWEST_ROWS and all(_ROW.fullmatch(row) for row in rows)


def _activity(name: str) -> str | None:
    match = _FILE_NAME.fullmatch(name)
    if match is None:
        return None
    code = match.group(1)
    return "fall" if code.startswith("F") else ACTIVITIES.get(code)


def _check_bits(table: NumberTable) -> None:
    """Refuse numbers that have more bits than the sensor."""
    for names, bits in _BITS:
        for name in names:
            numbers = table.numbers(name)
            # NaN, of a blank line, is no number and compares as false.
            wrong = np.flatnonzero((numbers < -(2 ** (bits - 1))) | (numbers >= 2 ** (bits - 1)))
            if len(wrong):
                raise RecordingError(
                    f"{table.place}, line {wrong[0] + 1}, column {name!r}: {numbers[wrong[0]]:g} does not fit "
                    f"into the {bits} bits of this sensor; restore the file"
                )


def _device(table: NumberTable, cut_warning: tuple[str, ...]) -> DeviceRecording:
    written = table.has_values(_COLUMNS)  # a blank line is no sample and takes no time
    time_s = np.arange(int(written.sum())) / _RATE_HZ
    force_mps2 = _FORCE_MPS2_PER_BIT * table.stack(_FORCE)[written]
    rate_radps = _RATE_RADPS_PER_BIT * table.stack(_RATE)[written]
    force, force_warnings = finite_signal(time_s, force_mps2, "specific force", table.place)
    rate, rate_warnings = finite_signal(time_s, rate_radps, "rotation rate", table.place)
    return DeviceRecording(
        model="SisFall box",
        specific_force=force,
        rotation_rate=rate,
        decisions=(
            "time is the row number at 200 Hz: the table has no time column",
            "specific force from the ADXL345, 1/256 g a bit; with the sign as written, which points up at rest",
            "rotation rate from the ITG3200, 4000/65536 deg/s a bit",
            "the second accelerometer (MMA8451Q) is not used: it measures the same in a smaller range",
        ),
        warnings=(*force_warnings, *rate_warnings, *cut_warning),
    )
