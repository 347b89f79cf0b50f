"""Read the annotations (XML) of a WeAllWalk walk: every heel strike with its foot, and the turns of the path."""

from collections.abc import Iterator
from xml.etree.ElementTree import Element, ParseError

import numpy as np
from defusedxml import DefusedXmlException
from defusedxml.ElementTree import fromstring

from pdr_est.errors import RecordingError
from pdr_est.io.text.container import Source
from pdr_est.types.ground_truth import TrueSteps, TrueTurns, Truth


def is_annotation(head: bytes) -> bool:
    """Tell whether a file begins like an annotation."""
    return b"<PathSegment" in head


def read_annotation(source: Source) -> Truth:
    """Read steps and turns of an annotation, a source of one member.

    Raises
    ------
    RecordingError
        When it is damaged.
    """
    (member,) = source.members
    place = source.place(member)
    try:
        root = fromstring(source.read(member))
    except (ParseError, DefusedXmlException, ValueError) as error:
        raise RecordingError(f"{place}: cannot be read as an annotation ({error}); restore the file") from error
    steps = sorted((_number(step, "Time", place), _text(step, "WhichFoot", place)) for step in root.iter("Step"))
    turns = sorted(_turns(root, place))
    return Truth(
        steps=TrueSteps(np.array([time for time, _ in steps]), np.array([foot for _, foot in steps], dtype=np.str_)),
        turns=TrueTurns(np.array([time for time, _ in turns]), np.radians([angle for _, angle in turns])),
        step_count=len(steps),
    )


def _turns(root: Element, place: str) -> Iterator[tuple[float, float]]:
    """Read time, s, and angle, degrees, positive to the left, of every turn."""
    for segment in root.iter("PathSegment"):
        if segment.find("TurnInDegrees") is not None:
            yield _number(segment, "TurnTime", place), _number(segment, "TurnInDegrees", place)


def _text(parent: Element, tag: str, place: str) -> str:
    text = parent.findtext(tag)
    if text is None:
        raise RecordingError(f"{place}: a {parent.tag} has no {tag}; restore the file")
    return text.strip()


def _number(parent: Element, tag: str, place: str) -> float:
    text = _text(parent, tag, place)
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise RecordingError(f"{place}: {tag} {text!r} of a {parent.tag} is not a number; restore the file")
    return value
