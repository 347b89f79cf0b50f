"""Detect a step each time that a signal falls below one level after it was above another one."""

from pdr_est.frames import Array
from pdr_est.front_end.signal.event_detection import RefractoryPeriod, SchmittTrigger
from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import StepEvent


class HysteresisDetector:
    """Common part of UPTIME's baselines: a Schmitt trigger, a pause after each step, and the time of the steps.

    Parameters
    ----------
    rate_hz : float
        Sampling rate.
    delay_s : float
        Delay of the signal behind the movement, which is taken off the time of a step.
    above : float
        Level that arms the trigger: the signal must have been higher.
    below : float
        Level that fires it: the step is where the signal gets lower.
    min_interval_s : float
        Least time between two steps.
    """

    def __init__(self, rate_hz: float, delay_s: float, *, above: float, below: float, min_interval_s: float) -> None:
        self._above, self._below = above, below
        self._samples = SampleBuffer(rate_hz, delay_s)
        self._trigger = SchmittTrigger()
        self._refractory = RefractoryPeriod(min_interval_s)

    def begin_if_new_segment(self, block: LevelBlock) -> bool:
        """Return True if a new segment begins with this block, and forget the old one then."""
        if block.segment == self._samples.segment:
            return False
        self._samples.begin(block)
        self._trigger.reset()
        return True

    def push(self, block: LevelBlock, signal: Array) -> list[StepEvent]:
        """Return the steps of a block, whose signal has shape (n,)."""
        self._samples.append(block, signal)
        falls = self._trigger.push(signal > self._above, signal < self._below)
        events = [
            event for event in map(self._samples.event, falls.tolist()) if self._refractory.accepts(event.time_s)
        ]
        self._samples.drop(len(block))
        return events
