"""Find out what all columns of a table mean, from its titles together.

The documented titles come first, then names in any spelling. What one title leaves open, the others decide: `a`
beside `gF` is without gravity, `g` beside `a` is the gyroscope, `acceleration` beside `gravity` may be without it.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from pdr_est.io.tables.mapping import ClockColumn, QuantityColumns, TableMapping
from pdr_est.io.tables.quantities import AXES, CANONICAL, USUAL_UNITS, Quantity, quantities_of_unit, unit_factor
from pdr_est.io.tables.times.date_parts import find_date_parts
from pdr_est.io.tables.titles import TitleMeaning, understand_title
from pdr_est.io.tables.words.folding import split_words
from pdr_est.io.tables.words.sensors import Word

_RAW_WORDS = frozenset({"raw", "uncal", "uncalib", "uncalibrated"})
_SECOND_WORDS = frozenset({"sec", "secs", "seconds", "s"})
_NANOSECOND_WORDS = frozenset({"nsec", "nsecs", "nanosec", "nanosecs", "nanoseconds", "ns"})
_ACCELERATIONS = (Quantity.FORCE, Quantity.LINEAR)


@dataclass(frozen=True)
class _Group:
    """Titles of one sensor by axis."""

    word: Word
    prefix: str
    titles: Mapping[str, str]
    nameless: bool = False  # the titles are those of axes alone


def understand_titles(titles: Sequence[str], hint: Quantity | None = None, units: Sequence[str] = ()) -> TableMapping:
    """Find the meaning of the columns of a table from its titles.

    Parameters
    ----------
    titles
        Titles in the order of the file.
    hint
        Quantity of axes without a sensor's name, such as `x`, from the name of the file; None when it is not known.
    units
        Unit of each column from a row of its own; empty when there is none.

    Returns
    -------
    TableMapping
        Units that the titles state are in it; everything else is left to the values.
    """
    canonical = _canonical_columns(titles)
    taken = {title for columns in canonical.values() for title in columns.titles}
    unit_of = dict(zip(titles, units, strict=False))
    meanings = {
        title: _with_unit(understand_title(title), unit_of.get(title, "")) for title in titles if title not in taken
    }
    clocks = _clock_columns(titles, meanings, canonical)
    groups = _with_nameless_sensors(_groups(meanings, hint))
    columns: dict[Quantity, QuantityColumns] = dict(canonical)
    columns.pop(Quantity.TIME, None)
    for quantity, found in _chosen(groups, columns).items():
        columns[quantity] = _with_units(found, quantity, meanings)
    apple = next((g for g in groups if g.word.apple and _is_used(g, columns)), None)
    used = {title for one in columns.values() for title in one.titles}
    used |= {title for clock in clocks for title in clock.titles}
    return TableMapping(
        clocks=clocks,
        columns=columns,
        force_sign=None if apple is None else -1.0,
        incomplete=_incomplete(groups, columns),
        sign_reason="" if apple is None else f"Core Motion's titles, {next(iter(apple.titles.values()))}",
        unused=tuple(title for title in titles if title not in used and title.strip()),
    )


def _with_unit(meaning: TitleMeaning | None, unit: str) -> TitleMeaning | None:
    return replace(meaning, unit=unit) if meaning is not None and unit and not meaning.unit else meaning


def _canonical_columns(titles: Sequence[str]) -> dict[Quantity, QuantityColumns]:
    by_name = {title.casefold(): title for title in titles}
    return {
        quantity: QuantityColumns(tuple(by_name[name] for name in names), (1.0,) * len(names), canonical=True)
        for quantity, names in CANONICAL.items()
        if all(name in by_name for name in names)
    }


def _clock_columns(
    titles: Sequence[str], meanings: Mapping[str, TitleMeaning | None], canonical: Mapping[Quantity, QuantityColumns]
) -> tuple[ClockColumn, ...]:
    """List the columns that may tell the time: the documented one alone, else those with a plain name first."""
    if Quantity.TIME in canonical:
        return (ClockColumn(canonical[Quantity.TIME].titles[0], 1.0, canonical=True),)
    found = [
        (meaning.word.rank, title, meaning.unit)
        for title in titles
        if (meaning := meanings.get(title)) is not None and meaning.word is not None
        if meaning.word.quantity is Quantity.TIME
    ]
    ordered = [
        ClockColumn(title, unit_factor(Quantity.TIME, unit))
        for _, title, unit in sorted(found, key=lambda one: one[0])
    ]
    parts = find_date_parts([title for title in titles if meanings.get(title) is None or _is_time(meanings[title])])
    alone = [clock for clock in ordered if clock.title not in parts.values()]
    by_parts = (ClockColumn(parts["second"], parts=parts),) if parts else ()
    return (*_with_named_fractions(alone), *by_parts)


def _is_time(meaning: TitleMeaning | None) -> bool:
    return meaning is not None and meaning.word is not None and meaning.word.quantity is Quantity.TIME


def _with_named_fractions(clocks: Sequence[ClockColumn]) -> tuple[ClockColumn, ...]:
    """Join columns such as `stamp.secs` and `stamp.nsecs`, whose names tell that they belong together."""
    by_name = {_without_second(clock.title): clock for clock in clocks if _ends_with(clock.title, _SECOND_WORDS)}
    fractions = {
        clock.title: by_name[_without_second(clock.title)]
        for clock in clocks
        if _ends_with(clock.title, _NANOSECOND_WORDS) and _without_second(clock.title) in by_name
    }
    partner = {seconds.title: title for title, seconds in fractions.items()}
    return tuple(
        replace(clock, fraction=partner.get(clock.title, "")) for clock in clocks if clock.title not in fractions
    )


def _ends_with(title: str, words: frozenset[str]) -> bool:
    return split_words(title)[-1:] != [] and split_words(title)[-1] in words


def _without_second(title: str) -> tuple[str, ...]:
    return tuple(split_words(title)[:-1])


def _groups(meanings: Mapping[str, TitleMeaning | None], hint: Quantity | None) -> list[_Group]:
    """Put the titles of one sensor together."""
    found: dict[tuple[Word, str, bool], dict[str, str]] = defaultdict(dict)
    # Of two titles that mean the same the calibrated one counts.
    for title, meaning in sorted(meanings.items(), key=lambda one: not _RAW_WORDS.isdisjoint(split_words(one[0]))):
        word = None if meaning is None else meaning.word or _word_of_bare_axis(meaning, hint)
        if meaning is None or word is None or word.quantity is Quantity.TIME:
            continue
        nameless = meaning.word is None and hint is None and not meaning.unit
        found[word, meaning.prefix, nameless].setdefault(meaning.axis, title)
    return [_Group(word, prefix, axes, nameless) for (word, prefix, nameless), axes in found.items()]


def _with_nameless_sensors(groups: Sequence[_Group]) -> list[_Group]:
    """Take a second `x, y, z`, such as pandas' `x.1, y.1, z.1`, as a gyroscope until the values have told more.

    Which of the first two is the accelerometer is settled by gravity in the values; further ones are not used.
    """
    bare = [one for one in groups if one.nameless and {"x", "y", "z"} <= set(one.titles)]
    named = {one.word.quantity for one in groups if not one.nameless}
    if len(bare) < 2 or named & {*_ACCELERATIONS, Quantity.RATE}:
        return list(groups)
    second = replace(bare[1], word=Word(Quantity.RATE, 6, ambiguous=True))
    return [second if one is bare[1] else one for one in groups]


def _word_of_bare_axis(meaning: TitleMeaning, hint: Quantity | None) -> Word | None:
    """Give an axis without a name the quantity of its unit, else the hint, else an accelerometer to be confirmed."""
    if meaning.unit:
        by_unit = [quantity for quantity in quantities_of_unit(meaning.unit) if quantity is not Quantity.TIME]
        if hint in by_unit:
            return Word(hint, 5)
        if by_unit:
            return Word(by_unit[0], 5, by_unit[0] is Quantity.FORCE)
        if hint is None:
            return None  # an angle, a length …
    if hint is None and meaning.axis.isdigit():
        return None  # `values_0` is an axis only where something else names the sensor
    if hint is Quantity.ROTATION_VECTOR or hint is Quantity.ATTITUDE:
        return Word(hint, 5)
    if meaning.axis == "w":
        return Word(Quantity.ATTITUDE, 6)
    return Word(Quantity.FORCE if hint is None else hint, 6, hint is None)


def _by_axis(titles: Mapping[str, str], quantity: Quantity) -> Mapping[str, str]:
    """Name the axes of titles that count components, from 0 or from 1, also beside others that name theirs."""
    digits = {int(axis): title for axis, title in titles.items() if axis.isdigit()}
    if not digits:
        return titles
    named = {axis: title for axis, title in titles.items() if not axis.isdigit()}
    order = AXES[quantity]
    for first in (0, 1):
        numbered = {order[n - first]: title for n, title in digits.items() if 0 <= n - first < len(order)}
        if len(numbered) == len(digits) and set(order) <= {*named, *numbered}:
            return {**numbered, **named}
    return titles


def _chosen(groups: Sequence[_Group], canonical: Mapping[Quantity, QuantityColumns]) -> dict[Quantity, _Group]:
    """Choose one group for each quantity: the whole ones by rank, else what several spellings give together."""
    groups = [_as_attitude(group) for group in groups]
    chosen: dict[Quantity, _Group] = {}
    for quantity in Quantity:
        if quantity in canonical:
            continue
        whole = _whole_groups(groups, quantity)
        if whole:
            chosen[quantity] = whole[0]
        if quantity is Quantity.FORCE and len(whole) > 1 and whole[0].word.rank == 0 and whole[1].word.ambiguous:
            # `ax` beside `gFx`, or `acceleration` beside `accelerationIncludingGravity`, is without gravity.
            chosen[Quantity.LINEAR] = whole[1]
        if quantity is Quantity.RATE and len(whole) > 1 and whole[1].word.ambiguous:
            # `gx` beside `wx` may be gravity.
            chosen.setdefault(Quantity.GRAVITY, whole[1])
    if not {*_ACCELERATIONS} & {*chosen, *canonical}:
        mixed = _joined([group for group in groups if group.word.quantity in _ACCELERATIONS], Quantity.FORCE)
        if mixed is not None:
            chosen[Quantity.FORCE] = replace(mixed, word=Word(Quantity.FORCE, ambiguous=True))
    return chosen


def _whole_groups(groups: Sequence[_Group], quantity: Quantity) -> list[_Group]:
    """List the groups with all axes, best first; if there is none, that of all spellings together."""
    own = sorted((g for g in groups if g.word.quantity is quantity), key=lambda g: g.word.rank)
    named = [replace(group, titles=_by_axis(group.titles, quantity)) for group in own]
    whole = [group for group in named if set(AXES[quantity]) <= set(group.titles)]
    joined = None if whole else _joined(own, quantity)
    return whole if joined is None else [joined]


def _incomplete(groups: Sequence[_Group], columns: Mapping[Quantity, QuantityColumns]) -> tuple[str, ...]:
    """Name the sensors of which only some axes are there, and that nothing else stands for."""
    found = []
    for quantities in (_ACCELERATIONS, (Quantity.RATE,)):
        titles = [t for group in groups if group.word.quantity in quantities for t in group.titles.values()]
        if titles and not {*quantities} & {*columns}:
            found.append(f"{quantities[0]}: not used, because an axis is missing beside {', '.join(titles)}")
    return tuple(found)


def _as_attitude(group: _Group) -> _Group:
    """Take a rotation vector or orientation with a w as a quaternion."""
    if group.word.quantity is Quantity.ROTATION_VECTOR and set("wxyz") <= set(group.titles):
        return replace(group, word=replace(group.word, quantity=Quantity.ATTITUDE))
    return group


def _joined(groups: Sequence[_Group], quantity: Quantity) -> _Group | None:
    """Join what differently spelt titles of one quantity name; None when axes are still missing."""
    titles: dict[str, str] = {}
    for group in groups:
        for axis, title in group.titles.items():
            titles.setdefault(axis, title)
    named = _by_axis(titles, quantity)
    if not groups or not set(AXES[quantity]) <= set(named):
        return None
    word = replace(groups[0].word, ambiguous=any(g.word.ambiguous for g in groups))
    return _Group(word, "", named, all(g.nameless for g in groups))


def _with_units(group: _Group, quantity: Quantity, meanings: Mapping[str, TitleMeaning | None]) -> QuantityColumns:
    chosen = tuple(group.titles[axis] for axis in AXES[quantity])
    understood = [meaning for title in chosen if (meaning := meanings[title]) is not None]
    factors = tuple(unit_factor(quantity, meaning.unit) for meaning in understood)
    unknown = tuple(
        meaning.unknown_unit or (meaning.unit if factor is None and quantity in USUAL_UNITS else "")
        for meaning, factor in zip(understood, factors, strict=True)
    )
    return QuantityColumns(
        chosen,
        factors,
        ambiguous=group.word.ambiguous,
        other_order=next((meaning.other_order for meaning in understood if meaning.other_order), ()),
        unknown_units=unknown if any(unknown) else (),
        nameless=group.nameless,
    )


def _is_used(group: _Group, columns: Mapping[Quantity, QuantityColumns]) -> bool:
    titles = set(group.titles.values())
    return any(titles & set(one.titles) for q, one in columns.items() if q in (*_ACCELERATIONS, Quantity.GRAVITY))
