"""Templates of the pages, and how they write numbers."""

from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from pdr_est.output.visible_text import visible_text

NO_VALUE = "–"
"""Text in place of a number that is not there."""


def template_environment() -> Environment:
    """Make the environment that loads the templates of pages and formats their numbers."""
    made = Environment(
        loader=PackageLoader("pdr_est", "report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=lambda value: visible_text(value) if type(value) is str else value,
    )
    made.filters.update(
        number=format_number,
        percent=format_percent,
        seconds=format_duration,
        metric=format_metric_with_unit,
        time_span=format_time_span,
    )
    return made


def format_number(value: float | None, digits: int = 2) -> str:
    """Format a number for reading; None becomes a dash."""
    return NO_VALUE if value is None else f"{value:,.{digits}f}".replace(",", "\u202f").replace("-", "−")


def format_percent(value: float | None) -> str:
    """Format a fraction in percent."""
    return NO_VALUE if value is None else f"{format_number(100.0 * value, 1)} %"


def format_duration(value: float | None) -> str:
    """Format a duration: 8.4 s, 3 min 05 s, 2 h 07 min."""
    if value is None:
        return NO_VALUE
    if round(value, 1) < 60.0:
        return f"{value:.1f} s"
    minutes, rest = divmod(round(value), 60)
    return f"{minutes} min {rest:02d} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"


def format_time_span(begin_s: float | None, end_s: float | None) -> str:
    """Format the time span of a finding: 12.0 s, 12.0 to 15.5 s, or the whole walk without one."""
    if begin_s is None and end_s is None:
        return "whole walk"
    if begin_s is None or end_s is None:
        return f"until {end_s:.1f} s" if begin_s is None else f"from {begin_s:.1f} s on"
    return f"{begin_s:.1f} s" if begin_s == end_s else f"{begin_s:.1f} to {end_s:.1f} s"


def format_metric_with_unit(value: Any, name: str) -> str:
    """Format a metric with the unit that its name ends in."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        return NO_VALUE if value is None else str(value)
    if isinstance(value, int):
        return format_number(value, 0)
    unit = next((sign for suffix, sign in (("_m", "m"), ("_deg", "°"), ("_s", "s")) if name.endswith(suffix)), "")
    return f"{format_number(value, 2 if unit else 3)} {unit}".strip()
