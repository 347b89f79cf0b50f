"""Understand one column title: quantity, axis and unit, in any spelling."""

import re
import unicodedata
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
)
from pdr_est.io.tables.words.sensors import SENSORS, Word

_BRACKETS = re.compile(r"[\[(（【]([^\])）】]*)[\])）】]")
_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_SCRIPTS = re.compile(r"(?<=[A-Za-z0-9])(?=[^\W\d_A-Za-z])|(?<=[^\W\d_A-Za-z])(?=[A-Za-z0-9])", re.UNICODE)
_WORD = re.compile(r"[^\W_]+")
_LATIN_MARKS = re.compile(r"(?<=[a-z])[\u0300-\u036f]+")
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
    browser_angle
        True where the axis is the alpha, beta or gamma of a browser, which do not agree what they turn about.
    """

    word: Word | None
    axis: str = ""
    unit: str = ""
    prefix: str = ""
    browser_angle: bool = False


def understand_title(title: str) -> TitleMeaning | None:
    """Find out what a title means; None when it names nothing that the project uses."""
    base, unit, extra = _split_unit(title)
    words = split_words(base)
    readings = list(_without_unit_suffix(words, unit))
    with_extra = [([*rest, *extra], suffix) for rest, suffix in readings] if extra else []
    for rest, suffix in (*with_extra, *readings):
        found = _scalar(rest, suffix) or _sensor(rest, suffix) or _bare_axis(rest, suffix)
        if found is not None:
            return found
    return _time([*words, *extra], unit)


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


def split_words(text: str) -> list[str]:
    """Split a text into lower-case words at separators, changes of case and changes of script."""
    plain = unicodedata.normalize("NFKC", text)
    spaced = _SCRIPTS.sub(" ", _CAMEL.sub(" ", plain))
    return [_plain_word(word) for word in _WORD.findall(spaced)]


def _plain_word(word: str) -> str:
    """Write a word in lower case without the accents of Latin letters."""
    decomposed = unicodedata.normalize("NFD", word.casefold())
    return unicodedata.normalize("NFC", _LATIN_MARKS.sub("", decomposed))


def _split_unit(title: str) -> tuple[str, str, list[str]]:
    """Split a title into its base, the unit in brackets, and other words in brackets."""
    unit, extra = "", []
    for inside in _BRACKETS.findall(title):
        plain = inside.strip().lower()
        if is_unit(inside) and not unit and plain not in AXIS_WORDS and plain not in BLOCKED:
            unit = inside.strip()
        else:
            extra += split_words(inside)
    base = _BRACKETS.sub(" ", title).strip(" #%:\"'")
    if not unit and "/" in base:
        head, _, tail = base.partition(" ")
        if tail and is_unit(tail):
            base, unit = head, tail
        elif not tail:
            base, unit = _split_slash(base)
    return base, unit, extra


def _split_slash(base: str) -> tuple[str, str]:
    """Split `acc_x_m/s^2` before its unit."""
    parts = re.split(r"[_\s]", base)
    for i in range(1, len(parts)):
        tail = "_".join(parts[i:])
        if is_unit(tail):
            return "_".join(parts[:i]), tail
    return base, ""


def _without_unit_suffix(
    words: Sequence[str], unit: str, not_units: frozenset[str] = BLOCKED
) -> Iterator[tuple[list[str], str]]:
    """Iterate over the readings of a title: first with its last words as the unit, then without a unit."""
    if not unit:
        for length in range(min(_LONGEST_UNIT_WORDS, len(words) - 1), 0, -1):
            suffix = "".join(words[-length:])
            if quantities_of_unit(suffix) and suffix not in AXIS_WORDS and suffix not in not_units:
                yield list(words[:-length]), suffix
    yield list(words), unit


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
    for at in [*range(len(useful) - 1, 0, -1), 0] if len(useful) > 1 else []:
        axis = AXIS_WORDS.get(useful[at]) or BROWSER_ANGLES.get(useful[at])
        if axis is None:
            continue
        found = _named([*useful[:at], *useful[at + 1 :]], axis, unit)
        if found is not None:
            return replace(found, browser_angle=useful[at] in BROWSER_ANGLES)
    for start in range(len(useful)):
        joined = "".join(useful[start:])
        prefix = "".join(useful[:start])
        for stem, axis in ((joined[:-1], joined[-1:]), (joined[1:], joined[:1])):
            if axis in AXIS_WORDS and stem in SENSORS and not axis.isdigit() and not BLOCKED & set(useful[:start]):
                return TitleMeaning(SENSORS[stem], axis, unit, prefix)
        if joined[:-1] == "q" and joined[-1:].isdigit():
            return TitleMeaning(SENSORS["q"], joined[-1], unit, prefix)
    return None


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


def _bare_axis(words: Sequence[str], unit: str) -> TitleMeaning | None:
    """Recognise an axis without a sensor's name."""
    useful = [word for word in words if word not in FILLERS]
    if len(useful) == 1 and useful[0] in ("x", "y", "z", "w", "cos"):
        return TitleMeaning(None, AXIS_WORDS[useful[0]], unit)
    return None


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
