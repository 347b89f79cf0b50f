"""Format an inspection as readable text, as `pdr-est inspect` prints it."""

from collections.abc import Iterable

from pdr_est.preprocessing.quality.inspection import ChannelInspection, DeviceInspection, Inspection
from pdr_est.types.clock import utc_date

_MAX_LINES = 20  # of one kind; gaps can be many, and the rest is counted


def format_inspection(inspection: Inspection) -> str:
    """Format an inspection as lines of text; long lists are shortened (`Inspection.to_dict` has everything)."""
    lines = [f"{inspection.name}: {inspection.format}, {inspection.duration_s:.1f} s"]
    if inspection.start_unix_s is not None:
        lines.append(f"  time zero: {_format_unix_time(inspection.start_unix_s)}")
    if inspection.origin_deg is not None:
        latitude, longitude = inspection.origin_deg
        lines.append(f"  origin: latitude {latitude:.6f}, longitude {longitude:.6f}")
    lines += _labelled("truth", inspection.truth)
    lines += _labelled("fixes", inspection.fixes)
    lines += _labelled("note", inspection.notes)
    for device in inspection.devices:
        lines += _device_lines(device)
    return "\n".join(lines)


def _format_unix_time(unix_s: float) -> str:
    date = utc_date(unix_s)
    return f"{unix_s:g} s since 1970, not a date" if date is None else f"{date:%Y-%m-%d %H:%M:%S} UTC"


def _device_lines(device: DeviceInspection) -> list[str]:
    about = ", ".join(part for part in (device.model, device.platform) if part)
    lines = [f"device {device.name}{f' ({about})' if about else ''}"]
    lines += [f"  {_channel_line(channel)}" for channel in device.channels]
    lines += _labelled("possible", device.capabilities)
    if device.overlap is not None:
        lines.append(f"  accelerometer and gyroscope together: {device.overlap.length_s:.1f} s")
    if device.force_norm_mps2 is not None:
        lines.append(f"  check: median specific force {device.force_norm_mps2:.2f} m/s^2")
    if device.gravity_cosine is not None:
        lines.append(f"  check: cosine of specific force to the attitude's up {device.gravity_cosine:+.2f}")
    if device.rate_correlation is not None:
        lines.append(f"  check: correlation of gyroscope and attitude {device.rate_correlation:+.2f}")
    lines += _labelled("decided", device.decisions)
    return lines + _labelled("warning", (*device.findings, *device.warnings))


def _channel_line(channel: ChannelInspection) -> str:
    clock = channel.clock
    return (
        f"{channel.name}: {channel.samples} samples, {clock.rate_hz:.1f} Hz, "
        f"jitter {clock.jitter_p50_s * 1e3:.1f} ms (p50) {clock.jitter_p99_s * 1e3:.1f} ms (p99), "
        f"{channel.start_s:.2f} s to {channel.end_s:.2f} s"
    )


def _labelled(label: str, texts: Iterable[str]) -> list[str]:
    """Put a label before each text; count those beyond the longest list."""
    lines = [f"  {label}: {text}" for text in texts]
    hidden = len(lines) - _MAX_LINES
    return lines if hidden <= 0 else [*lines[:_MAX_LINES], f"  {label}: and {hidden} more"]
