"""Read the MotionSense data set: one table of an iPhone for each activity of a person.

A table has a header and columns of Core Motion (attitude as roll, pitch and yaw in rad, gravity and user acceleration
in g with Apple's sign, rotation rate in rad/s) at 50 Hz, without time. The name of its folder tells the activity.
"""

import re

import numpy as np

from pdr_est.frames import quaternion_from_core_motion
from pdr_est.io.conversion.axes import specific_force_from_core_motion, vertical_mismatch_warnings
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.types.ground_truth import Truth
from pdr_est.types.recording import DeviceRecording, Recording

NAME = "MotionSense"
BESIDE = re.compile(r"data_subjects_info\.csv(?:\.gz)?")
"""Names of files that are read beside a walk, or describe the data set."""

_ANGLES = ("attitude.roll", "attitude.pitch", "attitude.yaw")
_GRAVITY = ("gravity.x", "gravity.y", "gravity.z")
_RATE = ("rotationRate.x", "rotationRate.y", "rotationRate.z")
_USER = ("userAcceleration.x", "userAcceleration.y", "userAcceleration.z")
_COLUMNS = (*_ANGLES, *_GRAVITY, *_RATE, *_USER)
_RATE_HZ = 50.0
ACTIVITIES = {
    "wlk": "walking",
    "jog": "jogging",
    "std": "standing",
    "sit": "sitting",
    "ups": "upstairs",
    "dws": "downstairs",
}


def sniff(source: Source) -> bool:
    """Tell whether a member of the source is a table with the header of this data set."""
    return bool(find_members(source, _is_table))


def read_source(source: Source) -> Recording:
    """Read the walk of a MotionSense table: one iPhone, with the activity if the name of the folder tells it.

    Time is the row number at 50 Hz.

    Raises
    ------
    RecordingError
        When there are several walks or the table is damaged.
    """
    member = require_single_walk(source, find_members(source, _is_table), NAME)
    table = read_table(source.read(member), source.place(member), columns=_COLUMNS)
    folder = source.folder_name(member)
    return Recording(
        name=member_stem(member),
        format=NAME,
        devices=(_device(table),),
        truth=Truth(activity=_activity(folder)),
    )


def _is_table(head: bytes) -> bool:
    header = head.splitlines()[0].decode("utf-8", "replace") if head else ""
    names = {name.strip().strip('"') for name in header.split(",")}
    # A table with a time of its own is read by its header, not at an assumed rate.
    return set(_COLUMNS) <= names and not any("time" in name.lower() for name in names)


def _activity(folder: str) -> str | None:
    match = re.fullmatch(r"([a-z]{3})_\d+", folder)
    return ACTIVITIES.get(match.group(1)) if match else None


def _device(table: NumberTable) -> DeviceRecording:
    time_s = np.arange(len(table)) / _RATE_HZ
    gravity_g = table.stack(_GRAVITY)
    angles = [table.numbers(name) for name in _ANGLES]
    attitude = quaternion_from_core_motion(*angles)
    force, force_warnings = finite_signal(
        time_s, specific_force_from_core_motion(gravity_g, table.stack(_USER)), "specific force", table.place
    )
    rate, rate_warnings = finite_signal(time_s, table.stack(_RATE), "rotation rate", table.place)
    attitude_signal, attitude_warnings = finite_signal(time_s, attitude, "attitude", table.place)
    return DeviceRecording(
        model="iPhone",
        platform="ios",
        specific_force=force,
        rotation_rate=rate,
        attitude=attitude_signal,
        decisions=(
            "time is the row number at 50 Hz: the table has no time column",
            "specific force is -(gravity + user acceleration): Core Motion's g and sign",
            "attitude from roll, pitch and yaw as Rz(yaw) Rx(pitch) Ry(roll), device -> z up",
        ),
        warnings=(
            *force_warnings,
            *rate_warnings,
            *attitude_warnings,
            *vertical_mismatch_warnings(attitude, -gravity_g),
        ),
    )
