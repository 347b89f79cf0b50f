"""Run of the suite `speed`, one part after the other."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from pdr_est import __version__
from pdr_est.config import Config
from pdr_est.performance.growth import growth
from pdr_est.performance.online import online_latency
from pdr_est.performance.smoothing import smoothing_seconds
from pdr_est.performance.stages import stage_seconds, two_phones
from pdr_est.performance.whole_chain import whole_chain_cost

NAME = "speed"
LENGTHS_MIN = (10.0, 60.0, 480.0)
_RECORDED_MIN = 5.0
_CHAIN_MIN = 60.0
_ONLINE_MIN = 2.0
_SMOOTHED_STEPS = (1_000,)


@dataclass(frozen=True)
class SpeedResult:
    """Measured costs.

    Attributes
    ----------
    chains : tuple of dict
        Rows of `whole_chain_cost`.
    stage_seconds : dict
        Stage -> CPU seconds per minute of a two-phone recording.
    smoothing : tuple of dict
        Results of `smoothing_seconds`, with numbers of devices and steps.
    growth : tuple of dict
        Results of `growth`, with numbers of devices and minutes.
    online : dict
        Results of `online_latency`, by estimator.
    """

    chains: tuple[dict[str, Any], ...]
    stage_seconds: dict[str, float]
    smoothing: tuple[dict[str, float], ...]
    growth: tuple[dict[str, float], ...]
    online: dict[str, dict[str, float]]

    def to_dict(self) -> dict[str, Any]:
        """Make the JSON document; its `walks` are empty, so that it has the keys of a benchmark."""
        return {
            "suite": NAME,
            "version": __version__,
            "chains": list(self.chains),
            "stage_seconds_per_minute": self.stage_seconds,
            "smoothing": list(self.smoothing),
            "growth": list(self.growth),
            "online": self.online,
            "walks": [],
            "skipped": [],
        }


def run_speed(
    config: Config,
    lengths_min: Sequence[float] = LENGTHS_MIN,
    on_progress: Callable[[int, int], None] | None = None,
    chain_min: float = _CHAIN_MIN,
    recorded_min: float = _RECORDED_MIN,
    smoothed_steps: Sequence[int] = _SMOOTHED_STEPS,
    online_min: float = _ONLINE_MIN,
) -> SpeedResult:
    """Measure all parts.

    Parameters
    ----------
    config : Config
        Settings of the stages.
    lengths_min : sequence of float
        Lengths of the walks for the growth of time and memory, min.
    on_progress : Callable, optional
        Called with the number of finished parts and of all parts.
    chain_min : float
        Length of the recording for the whole chain, min.
    recorded_min : float
        Length of the recording for the stages, min.
    smoothed_steps : sequence of int
        Numbers of steps of the walks that bare GTSAM smooths, too.
    online_min : float
        Length of the walk that is pushed sample by sample, min.
    """
    walks = [(devices, minutes) for devices in (1, 2) for minutes in lengths_min]
    total = 3 + 2 * len(smoothed_steps) + len(walks)
    done = 0

    def finished(part: Any) -> Any:
        nonlocal done
        done += 1
        if on_progress is not None:
            on_progress(done, total)
        return part

    return SpeedResult(
        chains=finished(tuple(whole_chain_cost(chain_min, config))),
        stage_seconds=finished(stage_seconds(two_phones(recorded_min), recorded_min, config)),
        smoothing=tuple(
            finished({"devices": devices, "steps": steps, **smoothing_seconds(steps, devices)})
            for devices in (1, 2)
            for steps in smoothed_steps
        ),
        growth=tuple(
            finished({"devices": devices, "minutes": minutes, **growth(minutes, devices)})
            for devices, minutes in walks
        ),
        online=finished(online_latency(online_min)),
    )
