"""Whether devices recorded at the same time, which is all that ties their tracks."""

from collections.abc import Iterator, Mapping, Sequence

from pdr_est.errors import RecordingError
from pdr_est.types.measurements import LATE_START_S
from pdr_est.types.recording import DeviceRecording

# All ours. Less in common is a few steps, from which neither clocks nor tethers tell anything.
_LEAST_SHARED_S = 5.0
_LEAST_SHARE = 0.5  # of the longer of two short recordings
_EARLY_S = 10.0
_REMEDY = "tell how their clocks differ with --clock-offset or --messages, or smooth them one by one"

Span = tuple[float, float]


def refuse_apart(devices: Sequence[DeviceRecording], remedy: str = _REMEDY) -> None:
    """Raise RecordingError for a device that recorded with no other one for long enough. remedy: in words."""
    spans_s = _spans_s(devices)
    for name, own_s in spans_s.items():
        others = {other: span_s for other, span_s in spans_s.items() if other != name}
        if others and not any(_together(own_s, other_s) for other_s in others.values()):
            known = ", ".join(f"{other} {_words(span_s)}" for other, span_s in others.items())
            raise RecordingError(
                f"{name} recorded {_words(own_s)}, less than {_LEAST_SHARED_S:g} s of it together with another "
                f"device ({known}): {remedy}"
            )


def begun_late(devices: Sequence[DeviceRecording]) -> tuple[str, ...]:
    """Names of the devices that began so late that they may not have begun where the walk did."""
    spans_s = _spans_s(devices)
    first_s = min((begin_s for begin_s, _ in spans_s.values()), default=0.0)
    return tuple(name for name, (begin_s, _) in spans_s.items() if begin_s - first_s > LATE_START_S)


def outside_others(devices: Sequence[DeviceRecording]) -> Mapping[str, tuple[str, ...]]:
    """Of each device that began late or ended early, in words by its name: a track that another one has to make."""
    spans_s = _spans_s(devices)
    if len(spans_s) < 2:
        return {}
    first_s, last_s = min(begin_s for begin_s, _ in spans_s.values()), max(end_s for _, end_s in spans_s.values())
    return {name: tuple(_outside(span_s, first_s, last_s)) for name, span_s in spans_s.items()}


def _outside(span_s: Span, first_s: float, last_s: float) -> Iterator[str]:
    if span_s[0] - first_s > LATE_START_S:
        yield (
            f"began to record {span_s[0] - first_s:.1f} s after another device, "
            "whose track is the person's until then"
        )
    if last_s - span_s[1] > _EARLY_S:
        yield (f"ended {last_s - span_s[1]:.1f} s before another device, whose track is the person's from then on")


def _spans_s(devices: Sequence[DeviceRecording]) -> dict[str, Span]:
    return {device.name: span_s for device in devices if (span_s := device.span_s) is not None}


def _together(one_s: Span, two_s: Span) -> bool:
    shared_s = min(one_s[1], two_s[1]) - max(one_s[0], two_s[0])
    longer_s = max(one_s[1] - one_s[0], two_s[1] - two_s[0])
    return shared_s > 0.0 and shared_s >= min(_LEAST_SHARED_S, _LEAST_SHARE * longer_s)


def _words(span_s: Span) -> str:
    return f"from {span_s[0]:.1f} to {span_s[1]:.1f} s"
