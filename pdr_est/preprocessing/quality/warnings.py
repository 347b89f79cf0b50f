"""What makes steps and a track doubtful although they can be computed, in words for a warning."""

from collections.abc import Iterator

from pdr_est.preprocessing.quality.sensor_checks import check_clock, stuck_intervals
from pdr_est.preprocessing.sensor_ranges import SENSOR_RANGES, out_of_range
from pdr_est.types.recording import DeviceRecording, Signal
from pdr_est.types.sensors import Channel

_COVERED_SHARE = 0.98  # of the accelerometer's time: sensors start and stop one after the other
_COVERED_HALF = 0.5


def quality_warnings(device: DeviceRecording) -> tuple[str, ...]:
    """What is doubtful about a device's accelerometer and gyroscope; empty when nothing is."""
    force, rate = (_filled(signal) for signal in (device.specific_force, device.rotation_rate))
    found = [*_impossible("accelerometer", Channel.SPECIFIC_FORCE, force)]
    found += _impossible("gyroscope", Channel.ROTATION_RATE, rate)
    if force is not None:
        found += _stuck("accelerometer", force, rate, "no step is seen there")
    if rate is not None and not rate.values.any():
        found.append("all values of the gyroscope are zero, the sensor is absent or fake: no turn can be seen")
    elif rate is not None:
        found += _stuck("gyroscope", rate, force, "no turn is seen there")
    if force is not None and rate is not None:
        found += _uncovered(force, rate)
    return tuple(found)


def _filled(signal: Signal | None) -> Signal | None:
    return signal if signal is not None and len(signal) else None


def _impossible(name: str, channel: Channel, signal: Signal | None) -> Iterator[str]:
    count = 0 if signal is None else int(out_of_range(channel, signal.values).sum())
    if signal is not None and count:
        limit = SENSOR_RANGES[channel]
        yield (
            f"{count} of {len(signal)} samples of the {name} are beyond {limit.largest:g} {limit.unit}, "
            "which no phone can measure, and are left out"
        )


def _stuck(name: str, signal: Signal, other: Signal | None, effect: str) -> Iterator[str]:
    stretches = stuck_intervals(signal, () if other is None else (other,))
    if stretches:
        total_s = sum(stretch.length_s for stretch in stretches)
        yield f"the {name} is stuck from {stretches[0].start_s:.2f} s on, for {total_s:.1f} s in all: {effect}"


def _uncovered(force: Signal, rate: Signal) -> Iterator[str]:
    recorded_s = _running_s(force, force)
    covered_s = min(_running_s(rate, force), recorded_s)
    if covered_s >= _COVERED_SHARE * recorded_s:
        return
    words = (
        f"the gyroscope covers only {covered_s:.1f} of {recorded_s:.1f} s of the accelerometer: "
        "nothing outside is used"
    )
    if covered_s < _COVERED_HALF * recorded_s:
        words += "; `pdr-est steps` finds more steps in a recording without the gyroscope"
    yield words


def _running_s(signal: Signal, within: Signal) -> float:
    """How long a signal was recorded, less its gaps, in the time from the first to the last sample of another."""
    start_s, end_s = within.time_s.min(), within.time_s.max()
    inside_s = signal.time_s[(signal.time_s >= start_s) & (signal.time_s <= end_s)]
    if len(inside_s) < 2:
        return 0.0
    gaps_s = sum(gap.length_s for gap in check_clock(inside_s).gaps)
    return float(inside_s.max() - inside_s.min()) - gaps_s
