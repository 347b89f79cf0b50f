"""Find the files of one walk among the members of a source, and the sensor that each of them holds."""

from collections.abc import Mapping
from dataclasses import dataclass

from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.quantities import AXES, MOTION, Quantity
from pdr_est.io.tables.signals import layout_of
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.container import Source, SourceKind
from pdr_est.io.text.members import member_stem
from pdr_est.io.text.table_layout import TableLayout

_BESIDE = (Quantity.ACCURACY, Quantity.TRUE_POSITION)
_HEAD_BYTES = 2048
_SECOND_CHOICE = ("uncal", "raw", "game")
_NO_TABLES = (".jpg", ".png", ".mp4", ".pdf", ".wav", ".m4a", ".py", ".m", ".ipynb")


@dataclass(frozen=True)
class SensorFile:
    """Member that holds one sensor.

    Attributes
    ----------
    member
        Name of the member.
    quantity
        What it holds.
    layout
        How its table is written.
    """

    member: str
    quantity: Quantity
    layout: TableLayout

    @property
    def is_second_choice(self) -> bool:
        """Tell whether a calibrated file of the same sensor is better."""
        stem = member_stem(self.member).casefold()
        return any(word in stem for word in _SECOND_CHOICE)


def sensor_file_walks(source: Source) -> Mapping[str, tuple[SensorFile, ...]]:
    """Find walk -> files of its sensors; a walk is a folder, and has an accelerometer or a gyroscope.

    The name of a file tells its sensor, or else that of its folder. A file by itself is a plain table.
    """
    named: dict[str, list[tuple[str, Quantity]]] = {}
    if source.kind is SourceKind.FILE:
        return {}
    for member in source.members:
        if member.casefold().endswith(_NO_TABLES):
            continue
        folder, _, _ = member.rpartition("/")
        quantity = _quantity_of_name(member_stem(member))
        if quantity is None and folder:
            above, _, last = folder.rpartition("/")
            quantity, folder = _quantity_of_name(last), above
        if quantity is not None:
            named.setdefault(folder, []).append((member, quantity))
    walks = {}
    for folder, members in named.items():
        if not any(quantity in MOTION for _, quantity in members):
            continue
        files = tuple(file for member, quantity in members if (file := _file(source, member, quantity)) is not None)
        if any(file.quantity in MOTION for file in files):
            walks[folder] = files
    return walks


def _quantity_of_name(name: str) -> Quantity | None:
    """Find the sensor that a name tells; a single letter is the number of a walk rather than a sensor."""
    return sensor_by_name(name) if sum(character.isalpha() for character in name) > 1 else None


def _file(source: Source, member: str, quantity: Quantity) -> SensorFile | None:
    """Look at the beginning of a file; None when it is no table of one sensor with a time."""
    layout = layout_of(source.head(member, _HEAD_BYTES))
    if layout is None:
        return None
    if not layout.has_header:
        return SensorFile(member, quantity, layout) if len(layout.titles) > len(AXES[quantity]) else None
    mapping = understand_titles(layout.titles, quantity, layout.units)
    held = [found for found in mapping.columns if found not in _BESIDE]
    if not mapping.has_time or not held:
        return None
    if quantity in held:
        return SensorFile(member, quantity, layout)
    return SensorFile(member, held[0], layout) if len(held) == 1 else None
