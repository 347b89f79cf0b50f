"""The stage that gives steps on stairs their length at the end of the walk."""

from collections import deque
from collections.abc import Sequence

from pdr_est.front_end.step_length.length_mixture import mixture_mean_and_sigma
from pdr_est.front_end.step_length.stairs.flight_watch import FlightWatch
from pdr_est.front_end.step_length.stairs.stair_params import StairParams
from pdr_est.front_end.step_length.stairs.vertical_motion import VerticalMotionMeter, step_duration_s
from pdr_est.front_end.step_length.walk_run_model import share_of_running
from pdr_est.records import changed
from pdr_est.types.steps import Step

_AT_ONCE = 1024  # steps whose samples are looked at together, which bounds the memory


class StairLengths:
    """Stage Step -> Step that makes the length a mixture of the given one and that of a tread.

    The weight is the probability that the step lies on stairs, from the vertical motion before and after it; nobody
    runs there. Only steps with the phone held in front of the body, or of unknown carrying mode, tell anything
    themselves. In a pocket or bag sharp turns look like short flights, and no walk on stairs with a phone there was
    at hand to learn the difference.

    A step comes out when no later one can change its probability, at the end of the recording at the latest.

    Parameters
    ----------
    parameters : StairParams
        Dimensions of stairs, and the noise of the vertical motion.
    """

    latency_s = float("inf")  # the end of the recording

    def __init__(self, parameters: StairParams) -> None:
        self._parameters = parameters
        self._meter = VerticalMotionMeter()
        self._flights = FlightWatch(parameters)
        self._waiting: deque[Step] = deque()

    def push(self, item: Step, /) -> list[Step]:
        """Take in a step; return those whose probability is final."""
        return self.push_all([item])

    def push_all(self, items: Sequence[Step], /) -> list[Step]:
        """Take in steps; return those whose probability is final."""
        final: list[Step] = []
        for begin in range(0, len(items), _AT_ONCE):
            steps = items[begin : begin + _AT_ONCE]
            self._waiting += steps
            final += map(self._with_length, self._flights.add(self._meter.motions(steps)))
        return final

    def flush(self) -> list[Step]:
        """Return the other steps."""
        return [self._with_length(probability) for probability in self._flights.finish()]

    def _with_length(self, on_stairs: float) -> Step:
        """Give the first waiting step its length."""
        p = self._parameters
        step = self._waiting.popleft()
        if not on_stairs:
            return step
        on_stairs *= 1.0 - share_of_running(step, 1.0 / step_duration_s(step))
        length_m, sigma_m = mixture_mean_and_sigma(
            on_stairs,
            (step.length_m, step.sigma_length_m),
            (p.tread_m * step.recorded_share, p.sigma_tread_m),
        )
        return changed(step, length_m=length_m, sigma_length_m=sigma_m, stairs_probability=on_stairs)
