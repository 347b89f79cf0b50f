"""Entries of the legends, which are HTML beside the plots."""

from dataclasses import dataclass


@dataclass(frozen=True)
class LegendEntry:
    """A sign of a plot and what it means.

    sign: one that the template can draw; colour: CSS variable, no dashes. dashes: on and off of a broken line, in
    line widths.
    """

    sign: str
    colour: str
    label: str
    dashes: tuple[float, ...] = ()
