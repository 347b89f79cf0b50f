"""Find the files of one walk among the members of a source, and the sensor that each of them holds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.quantities import AXES, MOTION, Quantity
from pdr_est.io.tables.signals import HEAD_BYTES, layout_of
from pdr_est.io.tables.split.long_table import is_second_choice
from pdr_est.io.tables.split.reader import DeviceTables
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.tables.words.folding import split_words
from pdr_est.io.text.container import Source, SourceKind
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.members import member_stem
from pdr_est.io.text.table_layout import TableLayout

_ATTITUDES = (Quantity.ROTATION_VECTOR, Quantity.ATTITUDE)
_BESIDE = (Quantity.ACCURACY, Quantity.TRUE_POSITION)
_NO_TABLES = (".jpg", ".png", ".mp4", ".pdf", ".wav", ".m4a", ".py", ".m", ".ipynb", ".md", ".json", ".xml", ".yaml")


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
        """Tell whether another file of the same sensor is better: calibrated, or with the gyroscope in it."""
        stem = member_stem(self.member)
        without_gyroscope = self.quantity in _ATTITUDES and "mag" in stem.casefold()
        return is_second_choice(stem) or without_gyroscope


@dataclass(frozen=True)
class SensorFiles:
    """Files of the sensors of one walk.

    Attributes
    ----------
    files
        Those that can be read.
    empty
        Members that name a sensor and have no rows.
    by_name
        True where the names of the files tell the walk, and not their folder.
    """

    files: tuple[SensorFile, ...]
    empty: tuple[str, ...] = ()
    by_name: bool = False


@dataclass(frozen=True)
class _NamedMember:
    """Member that is named by a sensor: layout is None where it has no rows, has_time tells whether rows have one."""

    member: str
    quantity: Quantity
    layout: TableLayout | None
    has_time: bool = True

    @property
    def kind(self) -> tuple[Quantity, bool]:
        """Return the sensor, and whether a calibrated file of it is better."""
        return self.quantity, is_second_choice(member_stem(self.member))


def sensor_file_walks(source: Source) -> Mapping[str, SensorFiles]:
    """Find walk -> files of its sensors, of which one is an accelerometer or a gyroscope, with a time.

    The name of a file tells its sensor, or else that of its folder. The files of a folder are one walk, unless it has
    several of one sensor: what their names have beside the sensor then tells the walk, as `1_2` in `acc_1_2.txt` and
    `gyro_1_2.txt`. A file by itself is a plain table.
    """
    walks: dict[str, SensorFiles] = {}
    for folder, members in _named_members(source).items():
        for walk, found in _by_walk(folder, members).items():
            files = tuple(SensorFile(m.member, m.quantity, m.layout) for m in found if m.layout and m.has_time)
            if any(file.quantity in MOTION for file in files):
                empty = tuple(m.member for m in found if m.layout is None)
                walks[walk] = SensorFiles(files, empty, by_name=walk != folder)
    return walks


def files_without_time(source: Source) -> tuple[str, ...]:
    """List the files of motion sensors whose rows have no time."""
    return tuple(
        m.member
        for members in _named_members(source).values()
        for m in members
        if m.layout is not None and not m.has_time and m.quantity in MOTION
    )


def _named_members(source: Source) -> dict[str, list[_NamedMember]]:
    """Find folder -> members that are named by sensors, one of them by a motion sensor."""
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
    return {
        folder: [found for member, quantity in members if (found := _look_at(source, member, quantity)) is not None]
        for folder, members in named.items()
        if any(quantity in MOTION for _, quantity in members)
    }


def _quantity_of_name(name: str) -> Quantity | None:
    """Find the sensor that a name tells; a single letter is the number of a walk rather than a sensor."""
    return sensor_by_name(name) if sum(character.isalpha() for character in name) > 1 else None


def _by_walk(folder: str, members: Sequence[_NamedMember]) -> dict[str, list[_NamedMember]]:
    """Sort the files of a folder by walk."""
    if not _has_twins([m for m in members if m.layout is not None]):
        return {folder: list(members)}
    walks: dict[str, list[_NamedMember]] = {}
    for m in members:
        walks.setdefault(_without_sensor(member_stem(m.member)), []).append(m)
    if "" in walks or any(map(_has_twins, walks.values())):
        return {folder: list(members)}
    return {f"{folder}/{rest}" if folder else rest: found for rest, found in walks.items()}


def _has_twins(members: Sequence[_NamedMember]) -> bool:
    """Tell whether two files hold one sensor."""
    return len({m.kind for m in members}) < len(members)


def _without_sensor(stem: str) -> str:
    """Return what the name of a file has beside that of its sensor."""
    words, quantity = split_words(stem), sensor_by_name(stem)
    kept = []
    for i, word in enumerate(words):
        without = " ".join([*words[:i], *words[i + 1 :]])
        if sensor_by_name(word) is not quantity and sensor_by_name(without) is quantity:
            kept.append(word)
    return "_".join(kept)


def _look_at(source: Source, member: str, quantity: Quantity) -> _NamedMember | None:
    """Look at the beginning of a file; None when it is a table of something else."""
    head = source.head(member, HEAD_BYTES)
    layout = layout_of(head)
    if layout is None:
        return _NamedMember(member, quantity, None) if _has_no_rows(head) else None
    if not layout.has_header:
        return _NamedMember(member, quantity, layout, len(layout.titles) > len(AXES[quantity]))
    mapping = understand_titles(layout.titles, quantity, layout.units)
    held = [found for found in mapping.columns if found not in _BESIDE]
    if quantity in held:
        return _NamedMember(member, quantity, layout, mapping.has_time)
    return _NamedMember(member, held[0], layout, mapping.has_time) if len(held) == 1 else None


def _has_no_rows(head: bytes) -> bool:
    """Tell whether a file is empty, or ends after its titles."""
    lines = [line for line in as_utf8(head).split(b"\n") if line.strip()]
    return len(lines) < 2


def by_device(files: Sequence[Sequence[DeviceTables]]) -> tuple[DeviceTables, ...]:
    """Put the tables of each device together, which the rows of the files may name."""
    found: dict[str, DeviceTables] = {}
    for one in (one for devices in files for one in devices):
        known = found.get(one.name)
        if known is not None:
            decisions = tuple(dict.fromkeys((*known.decisions, *one.decisions)))
            warnings = tuple(dict.fromkeys((*known.warnings, *one.warnings)))
            one = DeviceTables(one.name, (*known.tables, *one.tables), decisions, warnings)
        found[one.name] = one
    named = [one for name, one in found.items() if name]
    if not named or "" not in found:
        return tuple(found.values())
    shared = found[""]  # a file of all devices, such as that of the only receiver of satellites
    return (replace(named[0], tables=(*named[0].tables, *shared.tables)), *named[1:])
