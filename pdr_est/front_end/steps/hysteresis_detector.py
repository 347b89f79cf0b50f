"""A step each time that a signal falls below one level after it was above another one."""

from pdr_est.frames import Array
from pdr_est.front_end.signal.trigger import Refractory, Trigger
from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import StepEvent


class TriggeredSteps:
    """What UPTIME's baselines share: the trigger, a pause after each step, and where the steps belong.

    delay_s: how long before its sign in the signal a step happened. above: the signal must have been higher; below:
    the step is where it gets lower. min_interval_s: between steps.
    """

    def __init__(self, rate_hz: float, delay_s: float, *, above: float, below: float, min_interval_s: float) -> None:
        self._above, self._below = above, below
        self._samples = SampleBuffer(rate_hz, delay_s)
        self._trigger = Trigger()
        self._refractory = Refractory(min_interval_s)

    def begins(self, block: LevelBlock) -> bool:
        """Whether a new segment begins with this block; if so the old one is forgotten."""
        if block.segment == self._samples.segment:
            return False
        self._samples.begin(block)
        self._trigger.reset()
        return True

    def push(self, block: LevelBlock, signal: Array) -> list[StepEvent]:
        """The steps of a block, whose signal is (n,)."""
        self._samples.append(block, signal)
        falls = self._trigger.push(signal > self._above, signal < self._below)
        events = [
            event for event in map(self._samples.event, falls.tolist()) if self._refractory.accepts(event.time_s)
        ]
        self._samples.drop(len(block))
        return events
