"""Check that the devices of a walk recorded at the same time, without which nothing connects their tracks."""

from collections.abc import Iterator, Mapping, Sequence

from pdr_est.errors import RecordingError
from pdr_est.types.measurements import LATE_START_S
from pdr_est.types.recording import DeviceRecording

# All ours. Less than this in common is a few steps, which determine neither clocks nor tethers.
_LEAST_SHARED_S = 5.0
_LEAST_SHARE = 0.5  # of the longer of two short recordings
_EARLY_S = 10.0
_REMEDY = "tell how their clocks differ with --clock-offset or --messages, or smooth them one by one"

TimeSpan = tuple[float, float]


def require_overlap(devices: Sequence[DeviceRecording], remedy: str = _REMEDY) -> None:
    """Check that every device recorded long enough together with at least one other device.

    Parameters
    ----------
    devices
        Devices with their times on one clock.
    remedy
        Advice that ends the error message.

    Raises
    ------
    RecordingError
        For a device that shares less than 5 s (or half of the longer recording, if that is less) with every other.
    """
    spans_s = _spans_s(devices)
    for name, own_s in spans_s.items():
        others = {other: span_s for other, span_s in spans_s.items() if other != name}
        if others and not any(_overlap_enough(own_s, other_s) for other_s in others.values()):
            known = ", ".join(f"{other} {_format_span(span_s)}" for other, span_s in others.items())
            raise RecordingError(
                f"{name} recorded {_format_span(own_s)}, less than {_LEAST_SHARED_S:g} s of it together with another "
                f"device ({known}): {remedy}"
            )


def devices_started_late(devices: Sequence[DeviceRecording]) -> tuple[str, ...]:
    """Name the devices that began to record so late that they may not have begun where the walk did."""
    spans_s = _spans_s(devices)
    first_s = min((begin_s for begin_s, _ in spans_s.values()), default=0.0)
    return tuple(name for name, (begin_s, _) in spans_s.items() if begin_s - first_s > LATE_START_S)


def coverage_warnings(devices: Sequence[DeviceRecording]) -> Mapping[str, tuple[str, ...]]:
    """Warn of devices that began late or ended early; the track of the person then comes from other devices.

    Returns
    -------
    Mapping
        Device name -> its warnings; empty for a single device.
    """
    spans_s = _spans_s(devices)
    if len(spans_s) < 2:
        return {}
    first_s, last_s = min(begin_s for begin_s, _ in spans_s.values()), max(end_s for _, end_s in spans_s.values())
    return {name: tuple(_coverage_warnings(span_s, first_s, last_s)) for name, span_s in spans_s.items()}


def _coverage_warnings(span_s: TimeSpan, first_s: float, last_s: float) -> Iterator[str]:
    """Warn of a late beginning and an early end of one device."""
    if span_s[0] - first_s > LATE_START_S:
        yield (
            f"began to record {span_s[0] - first_s:.1f} s after another device, "
            "whose track is the person's until then"
        )
    if last_s - span_s[1] > _EARLY_S:
        yield (f"ended {last_s - span_s[1]:.1f} s before another device, whose track is the person's from then on")


def _spans_s(devices: Sequence[DeviceRecording]) -> dict[str, TimeSpan]:
    return {device.name: span_s for device in devices if (span_s := device.span_s) is not None}


def _overlap_enough(one_s: TimeSpan, two_s: TimeSpan) -> bool:
    shared_s = min(one_s[1], two_s[1]) - max(one_s[0], two_s[0])
    longer_s = max(one_s[1] - one_s[0], two_s[1] - two_s[0])
    return shared_s > 0.0 and shared_s >= min(_LEAST_SHARED_S, _LEAST_SHARE * longer_s)


def _format_span(span_s: TimeSpan) -> str:
    return f"from {span_s[0]:.1f} to {span_s[1]:.1f} s"
