"""Numbers of floors from their names, such as "F2", "B1", "ground" or "first floor"."""

import re
from collections.abc import Sequence

_ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")
_FLOOR = r"(?:[\s_.-]*(?:floor|level|storey))?"
_GROUND = re.compile(rf"(?:g|gf|eg|rdc|lobby|ground){_FLOOR}")
_ORDINAL = re.compile(rf"({'|'.join(_ORDINALS)}){_FLOOR}")
_PLAIN = re.compile(r"(?:(?:floor|level)\s+)?([+-]?\d+)")
_BELOW = re.compile(r"(?:b|ug|lg|basement)[\s_.-]*(\d*)")
_ABOVE = re.compile(r"(?:floor|level|storey|f|l)[\s_.-]*(\d+)")
_COUNTED = re.compile(rf"(\d+)(?:st|nd|rd|th|\.?\s*og){_FLOOR}")


def floor_number(name: str) -> int | None:
    """Return the number that a name of a floor means, 0 for the ground floor; None for a name that means none."""
    short = name.strip().casefold()
    if _GROUND.fullmatch(short):
        return 0
    if (ordinal := _ORDINAL.fullmatch(short)) is not None:
        return _ORDINALS.index(ordinal[1]) + 1
    if (below := _BELOW.fullmatch(short)) is not None:
        return -int(below[1] or 1)
    number = _PLAIN.fullmatch(short) or _ABOVE.fullmatch(short) or _COUNTED.fullmatch(short)
    return None if number is None else int(number[1])


def floor_numbers_of(names: Sequence[str]) -> list[int] | None:
    """Return the numbers of the floors of a building by their names; None if a name means no number.

    Where a building has floors such as B1 and F1 and none between them, F1 is the ground floor.
    """
    found = [floor_number(name) for name in names]
    numbers = [one for one in found if one is not None]
    if len(numbers) < len(found):
        return None
    by_letter = not any(re.fullmatch(r"[+-]?\d+", name.strip()) for name in names)
    if by_letter and 0 not in numbers and min(numbers) < 0 < max(numbers):
        return [number - 1 if number > 0 else number for number in numbers]
    return numbers
