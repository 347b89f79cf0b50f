"""Look of all figures, and SVG that stands inside an HTML document.

Figures carry no text from the recording (names, messages): that stands in the HTML around them, where it is escaped
and where no font has to be measured.
"""

import io
import re
from types import MappingProxyType

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pdr_est.frames import Array
from pdr_est.types.steps import CarryingMode

WIDTH_IN = 9.0
LEFT_IN, RIGHT_IN = 0.72, 0.16

# Colours as drawn; in the page each becomes the CSS variable of that name, so that it follows the light or dark
# theme.
INK = "#1d2430"
MUTED = "#69727f"
GRID = "#e3e6ea"
PAPER = "#fffffe"
FIX = "#c2188b"
DOUBT = "#d99a00"
# Devices. Red, blue, green and grey belong to the modes.
DEVICE_COLOURS = ("#7446a8", "#b08a00", "#00869b", "#8a5a3c")
# Red, blue and green as in MMPDR, the green bluish: at least 21 (CIE 1976) apart in every kind of colour-blindness.
MODE_COLOURS = MappingProxyType(
    {
        CarryingMode.UNKNOWN: "#949da9",
        CarryingMode.HOLDING: "#d4342c",
        CarryingMode.SWING: "#1f5fc9",
        CarryingMode.POCKET: "#00936a",
        CarryingMode.OTHER: "#828b96",
        CarryingMode.TRANS: "#4a525d",
    }
)
_CSS_NAMES = (
    {INK: "ink", MUTED: "muted", GRID: "grid", PAPER: "paper", FIX: "fix", DOUBT: "warn-edge"}
    | {colour: f"series-{number}" for number, colour in enumerate(DEVICE_COLOURS, start=1)}
    | {colour: f"mode-{mode.name.lower()}" for mode, colour in MODE_COLOURS.items()}
)

RASTER_DPI = 200  # of the dense layers that are drawn as an image


def device_colour(number: int) -> str:
    """Return the colour of the device with this number, counted from 0."""
    return DEVICE_COLOURS[number % len(DEVICE_COLOURS)]


def css_name(colour: str) -> str:
    """Return the CSS variable, without its dashes, that a drawn colour becomes in the page."""
    return _CSS_NAMES[colour]


def new_figure(height_in: float) -> Figure:
    """Make an empty figure of the page's width, independent of pyplot."""
    figure = Figure(figsize=(WIDTH_IN, height_in))
    figure.patch.set_visible(False)
    return figure


def add_axes(figure: Figure, bottom_in: float, height_in: float, share_x: Axes | None = None) -> Axes:
    """Add axes over the full width of the page, at a height counted in inches from below."""
    total_in = float(figure.get_size_inches()[1])
    box = (LEFT_IN / WIDTH_IN, bottom_in / total_in, 1.0 - (LEFT_IN + RIGHT_IN) / WIDTH_IN, height_in / total_in)
    axes = figure.add_axes(box, sharex=share_x)
    axes.patch.set_visible(False)
    axes.grid(True, color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(length=0, pad=5, colors=MUTED, labelsize=8.5)
    for side in axes.spines.values():
        side.set_visible(False)
    return axes


def label_axes(axes: Axes, x: str = "", y: str = "") -> None:
    """Label the axes with quantity and unit; the y labels of stacked axes are aligned."""
    axes.set_xlabel(x, color=INK, labelpad=5, fontsize=9.0)
    axes.set_ylabel(y, color=INK, fontsize=9.0)
    axes.yaxis.set_label_coords(-(LEFT_IN - 0.2) / (WIDTH_IN - LEFT_IN - RIGHT_IN), 0.5)


def to_svg(figure: Figure, name: str, description: str) -> str:
    """Convert the figure to an <svg> element without references to other files.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        Figure to convert.
    name : str
        Prefix of all ids, unique on the page.
    description : str
        Text for screen readers, plain ASCII without markup.
    """
    stream = io.StringIO()
    no_metadata = dict.fromkeys(("Date", "Creator", "Format", "Type"))
    # Text stays text: small, selectable, in the page's own font. A fixed salt: the same figure, the same file.
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "pdr_est", "path.simplify": True}):
        figure.savefig(stream, format="svg", dpi=RASTER_DPI, metadata=no_metadata)
    svg = stream.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r'\s(xmlns(:\w+)?|width|height)="[^"]*"', "", svg[: svg.index(">")]) + svg[svg.index(">") :]
    svg = svg.replace("<svg", f'<svg role="img" aria-label="{description}"', 1)
    svg = re.sub(r'\bid="', f'id="{name}-', svg)
    svg = svg.replace("url(#", f"url(#{name}-").replace('xlink:href="#', f'href="#{name}-')
    svg = svg.replace("xlink:href=", "href=")
    svg = re.sub(r"font: ([\d.]+px)[^;\"]*", r"font-size: \1", svg)
    return re.sub("|".join(_CSS_NAMES), lambda found: f"var(--{_CSS_NAMES[found.group()]})", svg)


def nice_step(span: float, count: int) -> float:
    """Find the number 1, 2 or 5 times a power of ten that divides `span` into at most `count` parts."""
    rough = span / count
    power = 10.0 ** np.floor(np.log10(rough))
    return float(next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= rough * (1 - 1e-9)))


def min_max_envelope(time_s: Array, values: Array, bins: int) -> tuple[Array, Array]:
    """Reduce a line to the least and greatest value of each bin, so that at most 2 * bins points fill the same area.

    Parameters
    ----------
    time_s : Array
        Ascending times, (n,), s.
    values : Array
        Values, (n,).
    bins : int
        Number of bins; one without samples is left out.

    Returns
    -------
    tuple of Array
        Times and values; those of a short line are returned unchanged.
    """
    if len(time_s) <= 2 * bins:
        return time_s, values
    edges = np.linspace(time_s[0], time_s[-1], bins + 1)
    first = np.unique(np.searchsorted(time_s, edges[:-1]))
    first = first[first < len(time_s)]
    low, high = np.fmin.reduceat(values, first), np.fmax.reduceat(values, first)
    return np.repeat(time_s[first], 2), np.column_stack([low, high]).ravel()
