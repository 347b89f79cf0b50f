"""Read WeAllWalk: one header-less table of 41 columns for each of two iPhones, and an XML file of annotations.

Tables hold Core Motion's values: time (s), quaternion (x, y, z, w), rotation rate (rad/s), user acceleration and
gravity (g, Apple's sign), magnetic field (uT). Phone `1L` is in the left pocket, phone `2R` in the right one.
"""

import io
import re

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.axes import specific_force_from_core_motion, vertical_mismatch, vertical_mismatch_warnings
from pdr_est.io.formats.datasets.weallwalk.annotations import is_annotation, read_annotation
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import discard_huge_values, finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import read_table
from pdr_est.types.ground_truth import Truth
from pdr_est.types.recording import DeviceRecording, Recording

NAME = "WeAllWalk"
BESIDE = re.compile(r".+\.xml(?:\.gz)?")
"""Names of files that are read beside a walk, or describe the data set."""

DEVICES = ("1L", "2R")
"""Phone 1 in the left pocket, phone 2 in the right one."""

_COLUMNS = tuple(f"column_{i}" for i in range(41))
_QUATERNION = (16, 13, 14, 15)  # stored x, y, z, w
_RATE = (17, 18, 19)
_USER = (20, 21, 22)
_GRAVITY = (23, 24, 25)
_MAGNETIC = (36, 37, 38)
_LARGEST_MISMATCH = 0.1
_SENSOR_FILE = re.compile(r"iPhoneSensors_(?P<path>T\d+_ID\d+)_(?P<device>1L|2R)_(?P<tool>\w+)")
_UNKNOWN_DEVICE = "device"


def sniff(source: Source) -> bool:
    """Tell whether a member of the source is a sensor table or an annotation of this data set."""
    return bool(find_members(source, _is_known))


def read_source(source: Source) -> Recording:
    """Read the walk that a sensor table, an annotation, or a folder with one walk belongs to.

    The other files of the walk are looked for beside it and in the folders `sensor` and `xml` next to its own. A
    missing phone or annotation is reported.

    Raises
    ------
    RecordingError
        When there are several walks or no sensor table.
    """
    members = find_members(source, _is_known)
    walk = require_single_walk(source, sorted({_walk_and_device(member)[0] for member in members}), NAME)
    tables, annotation = _files_of_walk(source, members[0], walk)
    if not tables:
        raise RecordingError(
            f"{source.place(members[0])}: the sensor table of this walk is missing; put it beside the annotation"
        )
    warnings = tuple(f"the walk's other phone {name} is missing" for name in DEVICES if name not in tables)
    return Recording(
        name=walk,
        format=NAME,
        devices=tuple(_device(name, table, warnings) for name, table in tables.items()),
        truth=Truth() if annotation is None else read_annotation(annotation),
        notes=() if annotation else ("no annotation (XML) of this walk, so no ground truth",),
    )


def _is_known(head: bytes) -> bool:
    return is_annotation(head) or _is_table(head)


def _is_table(head: bytes) -> bool:
    """Look for 41 numbers a row, with a quaternion that agrees with the recorded gravity."""
    lines = head.splitlines()[:-1][:10]
    if not lines or any(line.count(b",") != len(_COLUMNS) - 1 for line in lines):
        return False
    try:
        rows = discard_huge_values(np.loadtxt(io.BytesIO(b"\n".join(lines)), delimiter=",", ndmin=2))
    except ValueError:
        return False
    return vertical_mismatch(rows[:, _QUATERNION], -rows[:, _GRAVITY]) < _LARGEST_MISMATCH


def _walk_and_device(member: str) -> tuple[str, str]:
    match = _SENSOR_FILE.fullmatch(member_stem(member))
    if match is None:
        return member_stem(member), _UNKNOWN_DEVICE
    return f"{match['path']}_{match['tool']}", match["device"]


def _files_of_walk(source: Source, member: str, walk: str) -> tuple[dict[str, Source], Source | None]:
    """Find the sensor tables by device, and the annotation, of the walk of a member."""
    path, _, tool = walk.rpartition("_")
    names = {device: f"iPhoneSensors_{path}_{device}_{tool}.csv" for device in DEVICES}
    found = {device: _beside(source, member, "sensor", name) for device, name in names.items()}
    tables = {device: table for device, table in found.items() if table is not None}
    if not tables and not is_annotation(source.head(member)):
        tables = {_UNKNOWN_DEVICE: source.with_only(member)}
    return tables, _beside(source, member, "xml", f"{walk}.xml")


def _beside(source: Source, member: str, folder: str, name: str) -> Source | None:
    same = source.sibling(member, name)
    return source.sibling(member, f"../{folder}/{name}") if same is None else same


def _device(name: str, source: Source, warnings: tuple[str, ...]) -> DeviceRecording:
    (member,) = source.members
    table = read_table(source.read(member), source.place(member), has_header=False, columns=_COLUMNS)
    values = table.stack(_COLUMNS)
    attitude = _normalised(values[:, _QUATERNION])
    channels = {
        "specific force": specific_force_from_core_motion(values[:, _GRAVITY], values[:, _USER]),
        "rotation rate": values[:, _RATE],
        "magnetic field": values[:, _MAGNETIC],
        "attitude": attitude,
    }
    signals = {name: finite_signal(values[:, 0], rows, name, table.place) for name, rows in channels.items()}
    dropped = (warning for _, found in signals.values() for warning in found)
    return DeviceRecording(
        name=name,
        model="iPhone",
        platform="ios",
        specific_force=signals["specific force"][0],
        rotation_rate=signals["rotation rate"][0],
        magnetic_field=signals["magnetic field"][0],
        attitude=signals["attitude"][0],
        decisions=(
            "time is that of the table, which both phones and the annotation share",
            "specific force is -(gravity + user acceleration): Core Motion's g and sign",
            "rotation rate with Core Motion's own bias removed; magnetic field uncalibrated",
            "attitude from the quaternion columns in the order x, y, z, w, normalised, device -> z up",
        ),
        warnings=(*warnings, *dropped, *vertical_mismatch_warnings(attitude, -values[:, _GRAVITY])),
    )


def _normalised(quaternion: Array) -> Array:
    """Normalise quaternions; one of length zero becomes NaN, so that the row is dropped and counted."""
    norm = np.linalg.norm(quaternion, axis=1, keepdims=True)
    unit: Array = quaternion / np.where(norm > 0.0, norm, np.nan)
    return unit
