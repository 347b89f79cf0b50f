"""Draft the YAML file in which a person states what the columns of a table mean (`--map`)."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import yaml

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.tables.mapping import QuantityColumns, TableMapping
from pdr_est.io.tables.mapping_file import LOCATION, SECTIONS, SIGNS
from pdr_est.io.tables.placed import first_motion, place_signals
from pdr_est.io.tables.quantities import AXES, MOTION, Quantity, usual_unit
from pdr_est.io.tables.signals import TableSignals
from pdr_est.io.tables.values.settling import settle_quantities

_UNDERSTOOD = (*SECTIONS.values(), Quantity.LATITUDE_LONGITUDE, Quantity.ACCURACY)


def mapping_of_tables(tables: Sequence[TableSignals], sign: float | None = None) -> tuple[TableMapping, ...]:
    """Return the mappings by which the tables of one device are read as they were without any.

    Parameters
    ----------
    tables
        Tables as they were read.
    sign
        Sign of the acceleration by the format; None where the titles or the values tell.

    Returns
    -------
    tuple of TableMapping
        One for each table, with what the values have settled; a table that gives nothing has no columns.
    """
    zero = first_motion(tables).clock
    placed = place_signals(tables, zero.start, zero.epoch_s, RawDevice({}))
    settle_quantities(placed, RawDevice({}))
    found = []
    for table in tables:
        by_title = {", ".join(columns.titles): columns for columns in table.mapping.columns.values()}
        columns = {q: by_title[one.raw.title] for q, one in placed.items() if one.table is table and q in _UNDERSTOOD}
        clocks = table.mapping.clocks if table.clock.column is None else (table.clock.column,)
        stated = table.mapping.force_sign if sign is None else sign
        found.append(replace(table.mapping, clocks=clocks, columns=columns, force_sign=stated))
    return tuple(found)


def draft_mapping(mapping: TableMapping, titles: Sequence[str], sample: Sequence[str]) -> str:
    """Write the sections of a mapping file with what was understood of a table, to be completed.

    Parameters
    ----------
    mapping
        Meaning of the columns as far as it is known; with parts for the rows of several sensors.
    titles, sample
        All titles and the cells of the first row.
    """
    lines = ["# Columns and first row:"]
    lines += [
        f"#   {number}: {title} = {cell}" for number, (title, cell) in enumerate(zip(titles, sample, strict=False), 1)
    ]
    parts = [part for part in mapping.parts or (mapping,) if part.columns or not mapping.parts]
    clocks = {_time(part) for part in parts}
    lines.append(next(iter(clocks)) if len(clocks) == 1 else "# each sensor has a time of its own")
    rows = next((part.rows for part in parts if part.rows is not None), None)
    if rows is not None:
        lines.append(_line("sensor", {"column": rows[0]}))
    for name, quantity in SECTIONS.items():
        part = next((part for part in parts if quantity in part.columns), None)
        if part is not None:
            lines.append(_line(name, _settings(part, quantity, own_time=len(clocks) > 1)))
        elif quantity in (Quantity.FORCE, Quantity.RATE) and not mapping.parts and not mapping.file:
            lines.append(f"# {name}: {{x: ?, y: ?, z: ?, unit: {usual_unit(quantity, 1.0)}}}")
    for part in parts:
        lines += _location(part)
        lines += [f"# not used: {', '.join(part.unused)}"] if part.unused else []
    return "\n".join(lines) + "\n"


def _time(part: TableMapping) -> str:
    if part.rate_hz is not None:
        return _line("time", {"rate_hz": part.rate_hz})
    if not part.clocks:
        return "# time: {column: ?, unit: s}   # or {rate_hz: 50}"
    return _line("time", _clock(part))


def _clock(part: TableMapping) -> dict[str, Any]:
    clock = part.clocks[0]
    settings = {"column": clock.title} | ({"fraction": clock.fraction} if clock.fraction else {})
    return settings | _stated_unit(Quantity.TIME, (clock.factor,))


def _settings(part: TableMapping, quantity: Quantity, *, own_time: bool) -> dict[str, Any]:
    columns: QuantityColumns = part.columns[quantity]
    axes = (axis or "column" for axis in AXES[quantity])
    settings: dict[str, Any] = {} if part.rows is None else {"rows": part.rows[1]}
    turned = columns.turned or (1.0,) * len(columns.titles)
    titles = [title if sign > 0.0 else f"-{title}" for title, sign in zip(columns.titles, turned, strict=True)]
    settings |= dict(zip(axes, titles, strict=True)) | _stated_unit(quantity, columns.factors)
    if quantity in MOTION and quantity is not Quantity.RATE and part.force_sign is not None:
        settings["sign"] = next(name for name, sign in SIGNS.items() if sign == part.force_sign)
    return settings | ({"time": _clock(part)} if own_time and part.clocks else {})


def _location(part: TableMapping) -> list[str]:
    places = part.columns.get(Quantity.LATITUDE_LONGITUDE)
    if places is None:
        return []
    accuracy = part.columns.get(Quantity.ACCURACY)
    settings = dict(zip(LOCATION, places.titles, strict=True))
    return [_line("location", settings | ({} if accuracy is None else {"accuracy": accuracy.titles[0]}))]


def _stated_unit(quantity: Quantity, factors: tuple[float | None, ...]) -> dict[str, Any]:
    """Name the unit of columns that is known; nothing where it is not, or where they do not agree."""
    if len(set(factors)) != 1 or factors[0] is None:
        return {}
    name = usual_unit(quantity, factors[0])
    return {"unit": factors[0] if name is None else name}


def _line(section: str, settings: Mapping[str, Any]) -> str:
    text: str = yaml.safe_dump(
        dict(settings), default_flow_style=True, sort_keys=False, allow_unicode=True, width=10**6
    )
    return f"{section}: {text.strip()}"
