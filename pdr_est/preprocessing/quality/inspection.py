"""Inspect a recording: what it contains and what is wrong with it, as records that can be written as JSON."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from pdr_est.io.conversion.restored_gravity import rotation_agreement
from pdr_est.io.conversion.signs import gravity_cosine
from pdr_est.preprocessing.quality.capabilities import describe_capabilities
from pdr_est.preprocessing.quality.consistency import consistency_warnings
from pdr_est.preprocessing.quality.sampling_rate import SamplingRate, sampling_rate
from pdr_est.preprocessing.quality.sensor_checks import (
    ClockCheck,
    Interval,
    check_clock,
    clipped_axes,
    stuck_intervals,
)
from pdr_est.types.recording import DeviceRecording, Recording, Signal

_AXES = ("x", "y", "z")
_CLIPPING = ("specific_force", "rotation_rate")
_VECTORS = ("specific_force", "rotation_rate", "magnetic_field", "attitude")
_CHANNELS = (*_VECTORS, "linear_acceleration", "pressure")
_LEAST_CORRELATION = 0.3  # of gyroscope and attitude, below which their axes or signs do not agree


@dataclass(frozen=True)
class ChannelInspection:
    """Inspection of one channel.

    Attributes
    ----------
    name
        Channel, such as "specific_force".
    samples
        Number of samples.
    start_s, end_s
        Earliest and latest time stamp, s.
    clock
        Check of the time stamps.
    samples_hz, effective_rate_hz
        Rates of samples and of new values, Hz (`pdr_est.preprocessing.quality.sampling_rate`).
    hidden_by
        How the other values were made: "repeated", "interpolated", or "" when all are new.
    clipped_axes
        Axes that hit the end of their range.
    stuck
        Intervals without any change while another sensor moved.
    all_zero
        True when all values are zero.
    """

    name: str
    samples: int
    start_s: float
    end_s: float
    clock: ClockCheck
    samples_hz: float
    effective_rate_hz: float
    hidden_by: str
    clipped_axes: tuple[str, ...]
    stuck: tuple[Interval, ...]
    all_zero: bool


@dataclass(frozen=True)
class DeviceInspection:
    """Inspection of one device; a value that cannot be computed is None.

    Attributes
    ----------
    name, model, platform
        Identity of the device.
    channels
        Inspections of the channels that have samples.
    overlap
        Interval in which accelerometer and gyroscope both run; None when they never do.
    force_norm_mps2
        Median norm of the specific force, m/s^2; near 9.8 for correct units.
    gravity_cosine
        Median cosine between specific force and the up direction of the attitude; near +1 for correct signs.
    rate_correlation
        Correlation of the gyroscope with the change of the attitude; near +1 for correct axes and signs.
    capabilities
        What can be computed with these sensors.
    findings
        What is wrong with the channels.
    decisions
        How the reader found units and signs.
    warnings
        What the reader warned of.
    """

    name: str
    model: str
    platform: str
    channels: tuple[ChannelInspection, ...]
    overlap: Interval | None
    force_norm_mps2: float | None
    gravity_cosine: float | None
    rate_correlation: float | None
    capabilities: tuple[str, ...]
    findings: tuple[str, ...]
    decisions: tuple[str, ...]
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class Inspection:
    """Inspection of a recording.

    Attributes
    ----------
    name, format
        Name and file format of the recording.
    duration_s
        Time from the first to the last sample of any sensor, s.
    start_unix_s
        Unix time of time zero, s; None when unknown.
    origin_deg
        Latitude and longitude of the map frame's origin, degrees; None when unknown.
    devices
        Inspections of the devices.
    truth, fixes
        Summaries of ground truth and position fixes.
    notes
        Notes of the reader.
    """

    name: str
    format: str
    duration_s: float
    start_unix_s: float | None
    origin_deg: tuple[float, float] | None
    devices: tuple[DeviceInspection, ...]
    truth: tuple[str, ...]
    fixes: tuple[str, ...]
    notes: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Convert to nested plain values for JSON; numbers that are not finite become None."""
        plain: dict[str, Any] = _plain(asdict(self))
        return plain


def inspect_recording(recording: Recording) -> Inspection:
    """Inspect every sensor of a recording; it never raises, because everything wrong is part of the result."""
    devices = tuple(_inspect_device(device) for device in recording.devices)
    starts = [channel.start_s for device in devices for channel in device.channels]
    ends = [channel.end_s for device in devices for channel in device.channels]
    origin = recording.origin
    return Inspection(
        name=recording.name,
        format=recording.format,
        duration_s=max(ends) - min(starts) if starts else 0.0,
        start_unix_s=recording.epoch_s,
        origin_deg=None if origin is None else (origin.latitude_deg, origin.longitude_deg),
        devices=devices,
        truth=_summarise_truth(recording),
        fixes=_summarise_fixes(recording),
        notes=recording.notes,
    )


def _inspect_device(device: DeviceRecording) -> DeviceInspection:
    signals = {name: signal for name in _CHANNELS if (signal := getattr(device, name)) is not None and len(signal)}
    channels = tuple(_inspect_channel(name, signal, signals) for name, signal in signals.items())
    force, rate, attitude = (signals.get(name) for name in ("specific_force", "rotation_rate", "attitude"))
    correlation = None if attitude is None or rate is None else rotation_agreement(attitude, rate)
    overlap = None if force is None or rate is None else _overlap(force, rate)
    findings = [finding for channel in channels for finding in _channel_findings(channel)]
    if force is not None and rate is not None and overlap is None:
        findings.append("accelerometer and gyroscope never run at the same time: no track is possible")
    if correlation is not None and correlation < _LEAST_CORRELATION:
        findings.append(
            f"gyroscope and attitude do not rotate the same way (correlation {correlation:+.2f}): "
            "their axes or signs differ"
        )
    findings += consistency_warnings(device)
    return DeviceInspection(
        name=device.name,
        model=device.model,
        platform=device.platform,
        channels=channels,
        overlap=overlap,
        force_norm_mps2=None if force is None else float(np.median(np.linalg.norm(force.values, axis=1))),
        gravity_cosine=None if force is None or attitude is None else gravity_cosine(force, attitude),
        rate_correlation=correlation,
        capabilities=describe_capabilities(signals, overlap is not None),
        findings=tuple(findings),
        decisions=device.decisions,
        warnings=device.warnings,
    )


def _inspect_channel(name: str, signal: Signal, signals: Mapping[str, Signal]) -> ChannelInspection:
    clock = check_clock(signal.time_s)
    vector = name in _VECTORS
    others = [signals[other] for other in _CLIPPING if other in signals and other != name]
    rate = sampling_rate(signal) if vector else SamplingRate(clock.rate_hz, clock.rate_hz)
    return ChannelInspection(
        name=name,
        samples=len(signal),
        start_s=float(signal.time_s.min()),
        end_s=float(signal.time_s.max()),
        clock=clock,
        samples_hz=rate.samples_hz,
        effective_rate_hz=rate.new_hz,
        hidden_by=rate.hidden_by,
        clipped_axes=tuple(_AXES[i] for i in clipped_axes(signal.values)) if name in _CLIPPING else (),
        stuck=stuck_intervals(signal, others) if vector else (),
        all_zero=not signal.values.any(),
    )


def _overlap(a: Signal, b: Signal) -> Interval | None:
    start_s = max(float(a.time_s.min()), float(b.time_s.min()))
    end_s = min(float(a.time_s.max()), float(b.time_s.max()))
    return Interval(start_s, end_s - start_s) if end_s > start_s else None


def _channel_findings(channel: ChannelInspection) -> list[str]:
    """Describe what is wrong with a channel."""
    name, clock = channel.name, channel.clock
    findings = []
    if channel.samples == 1:
        findings.append(f"{name}: a single sample")
    if channel.all_zero:
        findings.append(f"{name}: all values are zero, the sensor is missing or faulty")
    elif channel.hidden_by:
        findings.append(
            f"{name}: values are {channel.hidden_by}, new ones come at about {channel.effective_rate_hz:.0f} Hz "
            f"instead of {channel.samples_hz:.0f} Hz"
        )
    if channel.clipped_axes:
        findings.append(f"{name}: axis {', '.join(channel.clipped_axes)} hits the end of its range")
    findings += [f"{name}: stuck from {i.start_s:.2f} s for {i.length_s:.2f} s" for i in channel.stuck]
    findings += [f"{name}: gap from {gap.start_s:.2f} s for {gap.length_s:.2f} s" for gap in clock.gaps]
    if clock.duplicates:
        findings.append(f"{name}: {clock.duplicates} repeated time stamps")
    if clock.backward_steps:
        findings.append(f"{name}: {clock.backward_steps} backward steps of the clock")
    return findings


def _summarise_truth(recording: Recording) -> tuple[str, ...]:
    truth = recording.truth
    summary = []
    if truth.positions is not None:
        summary.append(f"{len(truth.positions.time_s)} positions ({truth.positions.source})")
    if truth.steps is not None:
        summary.append(f"{len(truth.steps.time_s)} annotated steps")
    if truth.turns is not None:
        summary.append(f"{len(truth.turns.time_s)} annotated turns")
    if truth.step_count is not None:
        summary.append(f"step count {truth.step_count}")
    if truth.distance_m is not None:
        summary.append(f"distance {truth.distance_m:.1f} m")
    if truth.activity is not None:
        summary.append(f"activity {truth.activity}")
    return tuple(summary)


def _summarise_fixes(recording: Recording) -> tuple[str, ...]:
    """Summarise the fixes of each source: count, time span and median standard deviation."""
    summary = []
    for source in dict.fromkeys(fix.source for fix in recording.fixes):
        fixes = [fix for fix in recording.fixes if fix.source == source]
        times_s = [fix.time_s for fix in fixes]
        sigma_m = math.sqrt(float(np.median([np.trace(fix.covariance_m2) / 2.0 for fix in fixes])))
        span = f"{min(times_s):.1f} s to {max(times_s):.1f} s"
        summary.append(f"{len(fixes)} fixes ({source}), {span}, sigma about {sigma_m:.1f} m")
    return tuple(summary)


def _plain(value: Any) -> Any:
    """Convert records to plain values; numbers that are not finite become None."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
