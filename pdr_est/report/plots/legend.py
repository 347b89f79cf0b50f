"""Entries of the legends, which are HTML beside the plots."""

from dataclasses import dataclass


@dataclass(frozen=True)
class LegendEntry:
    """Symbol of a plot and its meaning.

    Attributes
    ----------
    symbol : str
        Name of a symbol that the template can draw.
    colour : str
        CSS variable of its colour, without dashes.
    label : str
        Meaning.
    dashes : tuple of float
        Lengths of dashes and gaps of a broken line, in line widths.
    """

    symbol: str
    colour: str
    label: str
    dashes: tuple[float, ...] = ()
