"""Cells of the tables that are written for spreadsheets."""

from typing import Any

_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def harmless_cell(cell: Any) -> Any:
    """Return a cell that no spreadsheet takes for a formula: a text that begins like one gets an apostrophe.

    A carriage return, which the csv module does not quote, becomes a blank.
    """
    if not isinstance(cell, str):
        return cell
    text = cell.replace("\r", " ")
    return f"'{text}" if cell.startswith(_FORMULA) else text


def harmless_name(name: str) -> str:
    """Return a name that no spreadsheet takes for a formula."""
    return str(harmless_cell(name))
