"""The text form of an inspection."""

from collections.abc import Iterable
from datetime import UTC, datetime

from pdr_est.preprocessing.quality.inspection import ChannelInspection, DeviceInspection, Inspection

_SHOWN = 20  # gaps can be many: the rest is counted


def format_inspection(inspection: Inspection) -> str:
    """An inspection as readable lines; `Inspection.to_dict` has all of it."""
    lines = [f"{inspection.name}: {inspection.format}, {inspection.duration_s:.1f} s"]
    if inspection.start_unix_s is not None:
        lines.append(f"  time zero: {_moment(inspection.start_unix_s)}")
    if inspection.origin_deg is not None:
        latitude, longitude = inspection.origin_deg
        lines.append(f"  origin: latitude {latitude:.6f}, longitude {longitude:.6f}")
    lines += _list("truth", inspection.truth) + _list("fixes", inspection.fixes) + _list("note", inspection.notes)
    for device in inspection.devices:
        lines += _device(device)
    return "\n".join(lines)


def _moment(unix_s: float) -> str:
    try:
        return f"{datetime.fromtimestamp(unix_s, tz=UTC):%Y-%m-%d %H:%M:%S} UTC"
    except (OverflowError, OSError, ValueError):
        return f"{unix_s:g} s since 1970, not a date"


def _device(device: DeviceInspection) -> list[str]:
    about = ", ".join(part for part in (device.model, device.platform) if part)
    lines = [f"device {device.name}{f' ({about})' if about else ''}"]
    lines += [f"  {_channel(channel)}" for channel in device.channels]
    lines += _list("possible", device.capabilities)
    if device.overlap is not None:
        lines.append(f"  accelerometer and gyroscope together: {device.overlap.length_s:.1f} s")
    if device.force_norm_mps2 is not None:
        lines.append(f"  check: median specific force {device.force_norm_mps2:.2f} m/s^2")
    if device.gravity_cosine is not None:
        lines.append(f"  check: cosine of specific force to the attitude's up {device.gravity_cosine:+.2f}")
    if device.rate_correlation is not None:
        lines.append(f"  check: correlation of gyroscope and attitude {device.rate_correlation:+.2f}")
    return lines + _list("decided", device.decisions) + _list("warning", (*device.findings, *device.warnings))


def _channel(channel: ChannelInspection) -> str:
    clock = channel.clock
    return (
        f"{channel.name}: {channel.samples} samples, {clock.rate_hz:.1f} Hz, "
        f"jitter {clock.jitter_p50_s * 1e3:.1f} ms (p50) {clock.jitter_p99_s * 1e3:.1f} ms (p99), "
        f"{channel.start_s:.2f} s to {channel.end_s:.2f} s"
    )


def _list(title: str, words: Iterable[str]) -> list[str]:
    lines = [f"  {title}: {text}" for text in words]
    hidden = len(lines) - _SHOWN
    return lines if hidden <= 0 else [*lines[:_SHOWN], f"  {title}: and {hidden} more"]
