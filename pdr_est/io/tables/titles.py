"""Understand one column title: quantity, axis and unit, in any spelling."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from pdr_est.io.tables.quantities import Quantity, is_unit, quantities_of_unit
from pdr_est.io.tables.words.columns import (
    AXIS_WORDS,
    BLOCKED,
    BROWSER_ANGLES,
    FILLERS,
    SCALARS,
    TIME_WORDS,
    TIMES,
    TURNED_AXES,
)
from pdr_est.io.tables.words.folding import split_words
from pdr_est.io.tables.words.sensors import SENSORS, Word

_BRACKETS = re.compile(r"[\[(（【{<「〔]([^\])）】}>」〕]*)[\])）】}>」〕]+")
_DIVIDED = re.compile(r"/\(([^()]*)\)")  # m/(s^2)
_IN_BRACKETS = re.compile("[,;]")
_BEFORE_UNIT = re.compile(r"[\s_,;:|/]+")
_LINKS = frozenset({"in", "en", "im", "-", "–", "unit", "units", "einheit"})
_NUMBERED = re.compile(r"([^\W\d_]+)(\d+)([^\W\d_]*)")
_LOOKS_LIKE_UNIT = re.compile(r"[/°²^·%]|-[12]$|^(lsb|adc|counts?|ticks|digits?)$|\bper\b", re.IGNORECASE)
_LONGEST_UNIT_WORDS = 4


@dataclass(frozen=True)
class TitleMeaning:
    """Meaning of one title.

    Attributes
    ----------
    word
        The quantity with its rank; None for an axis without a sensor's name.
    axis
        "x", "y", "z", "w", a digit that counts components, or the part of a position; "" where there is none.
    unit
        Unit as written, "" where the title has none.
    prefix
        What stands before the sensor's name, such as the place of one of several sensors.
    other_order
        Order in which x, y, z may be meant instead, where the title names an angle about which recorders do not
        agree what it turns about; empty for other titles.
    unknown_unit
        Text that stands where a unit stands, but is none that is known; "" where there is none.
    """

    word: Word | None
    axis: str = ""
    unit: str = ""
    prefix: str = ""
    other_order: tuple[int, ...] = ()
    unknown_unit: str = ""


@dataclass(frozen=True)
class _Parts:
    """Title taken apart: the text without brackets, its unit, the other texts in brackets, and their words."""

    base: str
    unit: str
    remarks: tuple[str, ...]
    words: tuple[str, ...]


def understand_title(title: str) -> TitleMeaning | None:
    """Find out what a title means; None when it names nothing that the project uses."""
    parts = _taken_apart(title)
    words = split_words(parts.base)
    words = _without_glue(words)
    readings = list(_without_unit_suffix(words, parts.unit))
    for remark in (parts.words, ()) if parts.words and not BLOCKED & set(parts.words) else (parts.words,):
        for rest, suffix in readings:
            found = _column([*rest, *remark], suffix)
            if found is not None:
                known = not parts.remarks or (remark and "".join(remark) not in found.prefix)
                return found if known else replace(found, unknown_unit=_unit_among(parts.remarks))
    return _time([*words, *parts.words], parts.unit)


def sensor_by_name(name: str) -> Quantity | None:
    """Find the quantity that a file name or the cell of a sensor column names; None when it names none.

    Parts around the sensor's name are ignored, such as the date in `2031-02-03_Accelerometer`.
    """
    words = [word for word in split_words(_BRACKETS.sub(" ", name)) if word not in FILLERS and not word.isdigit()]
    for length in range(len(words), 0, -1):
        for start in range(len(words) - length + 1):
            joined = "".join(words[start : start + length])
            if joined in SENSORS and len(joined) > 1:
                return SENSORS[joined].quantity
            if joined in SCALARS and length == len(words):
                return SCALARS[joined][0]
    joined = "".join(words)
    endings = [known for known in SENSORS if len(known) > 2 and joined.endswith(known)]
    return SENSORS[max(endings, key=len)].quantity if endings else None


def _taken_apart(title: str) -> _Parts:
    """Split a title into its base, the unit in brackets or behind it, and what else stands in brackets."""
    unit, remarks = "", []
    title = _DIVIDED.sub(r"/\1", title)
    for inside in (part for found in _BRACKETS.findall(title) for part in _IN_BRACKETS.split(found)):
        text = _without_link(inside)
        if is_unit(text) and not unit and not {text.lower()} & (BLOCKED | AXIS_WORDS.keys()):
            unit = text
        else:
            remarks.append(inside.strip())
    base = _BRACKETS.sub(" ", title).strip(" #%:\"'/,;|-")
    if not unit:
        base, unit = _without_unit(base)
    others = tuple(remark for remark in remarks if remark.lower() not in AXIS_WORDS)
    return _Parts(base, unit, others, tuple(word for remark in remarks for word in split_words(remark)))


def _without_unit(base: str) -> tuple[str, str]:
    """Split `acc_x_m/s^2`, `acc x in m/s²`, `acc_x, g` before the unit, where signs or commas make it one."""
    for found in _BEFORE_UNIT.finditer(base):
        head, tail = base[: found.start()], _without_link(base[found.end() :])
        signs = set(tail) & set("/°²^'") or set(found[0]) & set(",;:|/") or tail != base[found.end() :]
        is_word = tail.lower() in BLOCKED or tail.lower() in AXIS_WORDS
        quantities = quantities_of_unit(tail) if head and signs and not is_word else ()
        if quantities and (Quantity.TIME not in quantities or set(split_words(head)) & (TIMES | TIME_WORDS)):
            return " ".join(head.split()), tail
    return base, ""


def _without_link(text: str) -> str:
    """Take the word away by which a unit is linked to a title, as in `in degrees/s`."""
    first, _, rest = text.strip().partition(" ")
    return rest.strip() if rest and first.lower() in _LINKS else text.strip()


def _unit_among(remarks: Sequence[str]) -> str:
    """Return the remark that looks like a unit; "" where none does."""
    return next((remark for remark in remarks if _LOOKS_LIKE_UNIT.search(remark)), "")


def _without_unit_suffix(
    words: Sequence[str], unit: str, not_units: frozenset[str] = BLOCKED
) -> Iterator[tuple[list[str], str]]:
    """Iterate over the readings of a title: first with its last words as the unit, then without a unit."""
    if not unit:
        for length in range(min(_LONGEST_UNIT_WORDS, len(words) - 1), 0, -1):
            suffix = "".join(words[-length:])
            known = quantities_of_unit(suffix) or quantities_of_unit(" ".join(words[-length:]))
            if known and suffix not in AXIS_WORDS and suffix not in not_units:
                rest = words[:-length]
                yield list(rest[:-1] if len(rest) > 1 and rest[-1] in _LINKS else rest), " ".join(words[-length:])
        if len(words) > 2 and words[-1] in AXIS_WORDS and len(words[-2]) > 1:  # `acc_mg_x`
            quantities = quantities_of_unit(words[-2])
            if quantities and quantities[0] is not Quantity.TIME:
                yield [*words[:-2], words[-1]], words[-2]
    yield list(words), unit


def _without_glue(words: Sequence[str]) -> list[str]:
    """Cut an axis off the unit or the filler that is glued to it, as in `accelXg` and `gyroXrate`."""
    last = words[-1] if len(words) > 1 else ""
    if last[:1] in ("x", "y", "z") and (last[1:] in FILLERS | {"rate"} or quantities_of_unit(last[1:])):
        return [*words[:-1], last[0], last[1:]]
    return list(words)


def _column(words: Sequence[str], unit: str) -> TitleMeaning | None:
    """Recognise a column other than a time."""
    found = _scalar(words, unit) or _sensor(words, unit)
    if found is None and any(_NUMBERED.fullmatch(word) or word.isdigit() for word in words):
        found = _numbered(words, unit)
    return found or _bare_axis(words, unit) or _by_unit(words, unit)


def _scalar(words: Sequence[str], unit: str) -> TitleMeaning | None:
    """Recognise pressure, latitude, longitude and accuracy."""
    joined = "".join(words)
    if joined not in SCALARS:
        return None
    quantity, part = SCALARS[joined]
    return TitleMeaning(Word(quantity), part, unit)


def _sensor(words: Sequence[str], unit: str) -> TitleMeaning | None:
    """Recognise the name of a sensor with an axis before, inside or after it, or as part of its last word."""
    useful = [word for word in words if word not in FILLERS]
    return _sensor_of(list(words), unit) or (_sensor_of(useful, unit) if 0 < len(useful) < len(words) else None)


def _sensor_of(useful: list[str], unit: str) -> TitleMeaning | None:
    places = [*range(len(useful) - 1, 0, -1), 0] if len(useful) > 1 else []
    for at in sorted(places, key=lambda i: useful[i].isdigit()):  # a digit beside a letter counts sensors, not axes
        word = useful[at]
        axis = AXIS_WORDS.get(word) or BROWSER_ANGLES.get(word) or TURNED_AXES.get(word)
        found = None if axis is None else _named([*useful[:at], *useful[at + 1 :]], axis, unit)
        if found is not None and word in AXIS_WORDS:
            return found
        if found is not None and found.word is not None and found.word.quantity is Quantity.RATE:
            return replace(found, other_order=_ORDERS[word in TURNED_AXES])
    for start in range(len(useful)):
        joined = "".join(useful[start:])
        prefix = "".join(useful[:start])
        named = any(word in SENSORS and len(word) > 1 for word in useful[:start])  # `accel xg` is no gyroscope
        for stem, axis in ((joined[:-1], joined[-1:]), (joined[1:], joined[:1])):
            if axis not in AXIS_WORDS or axis.isdigit() or BLOCKED & set(useful[:start]):
                continue
            if stem in SENSORS and (len(stem) > 1 or not named):
                return TitleMeaning(SENSORS[stem], AXIS_WORDS[axis], unit, prefix)
        if joined[:-1] == "q" and joined[-1:].isdigit():
            return TitleMeaning(SENSORS["q"], joined[-1], unit, prefix)
        for angle, axis in TURNED_AXES.items():
            stem = joined.removeprefix(angle)
            if stem != joined and stem in SENSORS and SENSORS[stem].quantity is Quantity.RATE:
                return TitleMeaning(SENSORS[stem], axis, unit, prefix, other_order=_ORDERS[True])
    return None


# Columns of alpha, beta, gamma, and of pitch, roll, yaw, in the other of the two orders in which they are written.
_ORDERS = ((2, 0, 1), (1, 0, 2))


def _named(words: Sequence[str], axis: str, unit: str) -> TitleMeaning | None:
    """Recognise the name of a sensor, if need be after words that stand before or behind it."""
    for start in range(len(words)):
        stem = "".join(words[start:])
        if stem in SENSORS and (len(stem) > 1 or start == 0) and not BLOCKED & set(words[:start]):
            return TitleMeaning(SENSORS[stem], axis, unit, "".join(words[:start]))
    for end in range(len(words) - 1, 0, -1):
        stem = "".join(words[:end])
        if stem in SENSORS and len(stem) > 1 and not BLOCKED & set(words[end:]) and words[end] not in SENSORS:
            return TitleMeaning(SENSORS[stem], axis, unit, "".join(words[end:]))
    return None


def _numbered(words: Sequence[str], unit: str) -> TitleMeaning | None:
    """Recognise `acc1_x` and `GYROX2`, whose number counts sensors, and `acc1`, whose number counts axes."""
    numbers: list[str] = []
    rest: list[str] = []
    for word in words:
        match = _NUMBERED.fullmatch(word)
        if match is None and not word.isdigit():
            rest.append(word)
            continue
        numbers.append(word if match is None else match[2])
        rest += [part for part in match.groups()[::2] if part] if match is not None else []
    found = _sensor(rest, unit) or _bare_axis(rest, unit)
    if found is not None:
        return replace(found, prefix=found.prefix + "".join(numbers))
    return _sensor([*rest, *numbers], unit) if len(numbers) == 1 and len("".join(rest)) > 1 else None


def _bare_axis(words: Sequence[str], unit: str) -> TitleMeaning | None:
    """Recognise an axis without a sensor's name, with a number where several columns have the same title."""
    useful = [word for word in words if word not in FILLERS]
    number = useful[1] if len(useful) == 2 and useful[1].isdigit() else ""
    if len(useful) == 1 < len(words) and useful[0] in ("0", "1", "2", "3"):
        return TitleMeaning(None, useful[0], unit)
    if useful and len(useful) == 1 + bool(number) and useful[0] in ("x", "y", "z", "w", "cos", "х", "у"):
        return TitleMeaning(None, AXIS_WORDS[useful[0]], unit, number)
    return None


def _by_unit(words: Sequence[str], unit: str) -> TitleMeaning | None:
    """Recognise an axis of something with an unknown name by its unit: rad/s is of a gyroscope, whatever its name."""
    quantities = [one for one in quantities_of_unit(unit) if one in (Quantity.FORCE, Quantity.RATE, Quantity.FIELD)]
    if not quantities or BLOCKED & set(words) or (len(unit) == 1 and quantities[0] is not Quantity.FORCE):
        return None
    axes = [word for word in words if word in AXIS_WORDS and not word.isdigit()]
    name = [word for word in words if word not in axes]
    if not axes and words and len(words[-1]) > 1 and words[-1][-1] in "xyz":
        axes, name = [words[-1][-1]], [*words[:-1], words[-1][:-1]]
    if len(axes) != 1 or not name:
        return None
    return TitleMeaning(Word(quantities[0], 6), AXIS_WORDS[axes[0]], unit, "".join(name))


def _time(words: Sequence[str], unit: str) -> TitleMeaning | None:
    """Recognise a time, with a unit among its words."""
    word = Word(Quantity.TIME)
    for rest, suffix in _without_unit_suffix(words, unit, frozenset()):
        if "".join(rest) in TIMES:
            return TitleMeaning(word, "", suffix)
    if Quantity.TIME in quantities_of_unit(unit) and not set(words) & BLOCKED:
        return TitleMeaning(Word(Quantity.TIME, 3), "", unit, "".join(words))
    if set(words) & TIME_WORDS:
        units = [one for one in words if Quantity.TIME in quantities_of_unit(one) and len(one) > 1]
        return TitleMeaning(Word(Quantity.TIME, 2), "", unit or (units[-1] if units else ""), "".join(words))
    return None
