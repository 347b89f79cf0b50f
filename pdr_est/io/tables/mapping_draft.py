"""Draft the YAML file in which a person states what the columns of a table mean (`--map`)."""

from collections.abc import Mapping

import yaml

from pdr_est.io.tables.mapping import QuantityColumns, TableMapping
from pdr_est.io.tables.mapping_file import LOCATION, SECTIONS
from pdr_est.io.tables.quantities import AXES, Quantity, usual_unit


def draft_mapping(mapping: TableMapping, titles: tuple[str, ...], sample: tuple[str, ...]) -> str:
    """Write a mapping file with what was understood of a table, to be completed.

    Parameters
    ----------
    mapping
        Meaning of the columns as far as it is known.
    titles, sample
        All titles and the cells of the first row.
    """
    lines = [
        "# Meaning of the columns, for --map; docs/recorder-formats.md describes the file.",
        "# Columns and first row:",
    ]
    lines += [
        f"#   {number}: {title} = {cell}" for number, (title, cell) in enumerate(zip(titles, sample, strict=False), 1)
    ]
    if mapping.clocks:
        clock = mapping.clocks[0]
        settings = {"column": clock.title} | ({"fraction": clock.fraction} if clock.fraction else {})
        lines.append(_line("time", settings | _stated_unit(Quantity.TIME, (clock.factor,))))
    else:
        lines.append("# time: {column: ?, unit: s}   # or {rate_hz: 50}")
    for name, quantity in SECTIONS.items():
        if quantity in mapping.columns:
            lines.append(_line(name, _settings(mapping.columns[quantity], quantity)))
        elif quantity in (Quantity.FORCE, Quantity.RATE):
            lines.append(f"# {name}: {{x: ?, y: ?, z: ?, unit: {usual_unit(quantity, 1.0)}}}")
    places = mapping.columns.get(Quantity.LATITUDE_LONGITUDE)
    if places is not None:
        accuracy = mapping.columns.get(Quantity.ACCURACY)
        settings = dict(zip(LOCATION, places.titles, strict=True))
        lines.append(_line("location", settings | ({} if accuracy is None else {"accuracy": accuracy.titles[0]})))
    if mapping.unused:
        lines.append(f"# not used: {', '.join(mapping.unused)}")
    return "\n".join(lines) + "\n"


def _settings(columns: QuantityColumns, quantity: Quantity) -> dict[str, str]:
    axes = (axis or "column" for axis in AXES[quantity])
    return dict(zip(axes, columns.titles, strict=True)) | _stated_unit(quantity, columns.factors)


def _stated_unit(quantity: Quantity, factors: tuple[float | None, ...]) -> dict[str, str]:
    """Name the unit of columns whose titles state it; nothing where they do not agree."""
    if len(set(factors)) != 1 or factors[0] is None:
        return {}
    name = usual_unit(quantity, factors[0])
    return {} if name is None else {"unit": name}


def _line(section: str, settings: Mapping[str, str]) -> str:
    text: str = yaml.safe_dump(
        dict(settings), default_flow_style=True, sort_keys=False, allow_unicode=True, width=10**6
    )
    return f"{section}: {text.strip()}"
