"""What a recording holds and what is wrong with it, as records, JSON and text."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from pdr_est.io.conversion.units import gravity_cosine
from pdr_est.preprocessing.quality.sensor_checks import (
    ClockCheck,
    Interval,
    attitude_rate_correlation,
    check_clock,
    clipped_axes,
    effective_rate,
    stuck_intervals,
)
from pdr_est.types.recording import DeviceRecording, Recording, Signal

_AXES = ("x", "y", "z")
_RANGE_LIMITED = ("specific_force", "rotation_rate")
_VECTORS = ("specific_force", "rotation_rate", "magnetic_field", "attitude")
_CHANNELS = (*_VECTORS, "pressure")
_CONTRADICTION = 0.3  # correlation of gyroscope and attitude below which their axes or signs do not agree


@dataclass(frozen=True)
class ChannelInspection:
    """One sensor. effective_rate_hz: rate of really new values, and hidden_by says how the others were made
    ("repeated", "interpolated" or ""). clipped_axes: axes that hit the end of a range. stuck: stretches without any
    change while others moved. all_zero: nothing but zeros."""

    name: str
    samples: int
    start_s: float
    end_s: float
    clock: ClockCheck
    effective_rate_hz: float
    hidden_by: str
    clipped_axes: tuple[str, ...]
    stuck: tuple[Interval, ...]
    all_zero: bool


@dataclass(frozen=True)
class DeviceInspection:
    """One device. overlap: when accelerometer and gyroscope both run, None when never.
    force_norm_mps2: median norm of the specific force. gravity_cosine: of the specific force to the attitude's up,
    near 1. rate_correlation: of the gyroscope with the change of the attitude, near 1. Each None when unknown.
    capabilities: what is possible with these sensors. findings: what is wrong with them, in words."""

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
    """A recording. duration_s: from the first to the last sample of any sensor."""

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
        """Nested plain values for JSON; what is not finite is None."""
        plain: dict[str, Any] = _plain(asdict(self))
        return plain


def inspect_recording(recording: Recording) -> Inspection:
    """Look at every sensor of a recording. Raises nothing: what is wrong is in the result."""
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
        truth=_truth_in_words(recording),
        fixes=_fixes_in_words(recording),
        notes=recording.notes,
    )


def _inspect_device(device: DeviceRecording) -> DeviceInspection:
    signals = {name: signal for name in _CHANNELS if (signal := getattr(device, name)) is not None and len(signal)}
    channels = tuple(_inspect_channel(name, signal, signals) for name, signal in signals.items())
    force, rate, attitude = (signals.get(name) for name in ("specific_force", "rotation_rate", "attitude"))
    correlation = None if attitude is None or rate is None else attitude_rate_correlation(attitude, rate)
    overlap = None if force is None or rate is None else _overlap(force, rate)
    findings = [words for channel in channels for words in _channel_findings(channel)]
    if force is not None and rate is not None and overlap is None:
        findings.append("accelerometer and gyroscope never run at the same time: no track is possible")
    if correlation is not None and correlation < _CONTRADICTION:
        findings.append(f"gyroscope and attitude do not turn the same way (correlation {correlation:+.2f})")
    return DeviceInspection(
        name=device.name,
        model=device.model,
        platform=device.platform,
        channels=channels,
        overlap=overlap,
        force_norm_mps2=None if force is None else float(np.median(np.linalg.norm(force.values, axis=1))),
        gravity_cosine=None if force is None or attitude is None else gravity_cosine(force, attitude),
        rate_correlation=correlation,
        capabilities=_capabilities(signals, overlap),
        findings=tuple(findings),
        decisions=device.decisions,
        warnings=device.warnings,
    )


def _inspect_channel(name: str, signal: Signal, signals: Mapping[str, Signal]) -> ChannelInspection:
    clock = check_clock(signal.time_s)
    vector = name in _VECTORS
    others = [signals[other] for other in _RANGE_LIMITED if other in signals and other != name]
    rate_hz, hidden_by = effective_rate(signal, clock.rate_hz) if vector else (clock.rate_hz, "")
    return ChannelInspection(
        name=name,
        samples=len(signal),
        start_s=float(signal.time_s.min()),
        end_s=float(signal.time_s.max()),
        clock=clock,
        effective_rate_hz=rate_hz,
        hidden_by=hidden_by,
        clipped_axes=tuple(_AXES[i] for i in clipped_axes(signal.values)) if name in _RANGE_LIMITED else (),
        stuck=stuck_intervals(signal, others) if vector else (),
        all_zero=not signal.values.any(),
    )


def _overlap(a: Signal, b: Signal) -> Interval | None:
    start_s = max(float(a.time_s.min()), float(b.time_s.min()))
    end_s = min(float(a.time_s.max()), float(b.time_s.max()))
    return Interval(start_s, end_s - start_s) if end_s > start_s else None


def _channel_findings(channel: ChannelInspection) -> list[str]:
    name, clock = channel.name, channel.clock
    findings = []
    if channel.samples == 1:
        findings.append(f"{name}: a single sample")
    if channel.all_zero:
        findings.append(f"{name}: all values are zero, the sensor is absent or fake")
    elif channel.hidden_by:
        findings.append(
            f"{name}: values are {channel.hidden_by}, new ones come at about {channel.effective_rate_hz:.0f} Hz "
            f"instead of {clock.rate_hz:.0f} Hz"
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


def _capabilities(signals: Mapping[str, Signal], overlap: Interval | None) -> tuple[str, ...]:
    """What the sensors allow, and what a missing one takes away."""
    force, attitude = "specific_force" in signals, "attitude" in signals
    rate = "rotation_rate" in signals and bool(signals["rotation_rate"].values.any())
    if force and rate and overlap is None:
        return ("accelerometer and gyroscope never run at the same time: a track is not possible",)
    if force and rate:
        return ("steps, headings and a track",)
    if force:
        return ("no gyroscope: steps and distance are possible, headings and a track are not",)
    if rate or attitude:
        return ("no accelerometer: the turning of the device is possible, steps and a track are not",)
    return ("no accelerometer and no gyroscope: nothing can be estimated",)


def _truth_in_words(recording: Recording) -> tuple[str, ...]:
    truth = recording.truth
    words = []
    if truth.positions is not None:
        words.append(f"{len(truth.positions.time_s)} positions ({truth.positions.source})")
    if truth.steps is not None:
        words.append(f"{len(truth.steps.time_s)} annotated steps")
    if truth.turns is not None:
        words.append(f"{len(truth.turns.time_s)} annotated turns")
    if truth.step_count is not None:
        words.append(f"step count {truth.step_count}")
    if truth.distance_m is not None:
        words.append(f"distance {truth.distance_m:.1f} m")
    if truth.activity is not None:
        words.append(f"activity {truth.activity}")
    return tuple(words)


def _fixes_in_words(recording: Recording) -> tuple[str, ...]:
    """One line a source: count, time span and median standard deviation."""
    words = []
    for source in dict.fromkeys(fix.source for fix in recording.fixes):
        fixes = [fix for fix in recording.fixes if fix.source == source]
        times_s = [fix.time_s for fix in fixes]
        sigma_m = math.sqrt(float(np.median([np.trace(fix.covariance_m2) / 2.0 for fix in fixes])))
        span = f"{min(times_s):.1f} s to {max(times_s):.1f} s"
        words.append(f"{len(fixes)} fixes ({source}), {span}, sigma about {sigma_m:.1f} m")
    return tuple(words)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
