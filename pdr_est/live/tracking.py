"""The filter of a live walk in a thread of its own: inputs go into a queue, poses and notes come out."""

import queue
import threading
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pdr_est.config import Config
from pdr_est.errors import PdrError
from pdr_est.online import ExpectedDevice, Tracker, Update
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan
from pdr_est.types.height import WalkerHeight
from pdr_est.types.measurements import PositionFix
from pdr_est.types.sensors import SensorBlock


@dataclass(frozen=True)
class LiveSamples:
    """Samples of one phone for the filter.

    Attributes
    ----------
    device
        Name of the phone.
    blocks
        The samples.
    made_s
        Time at which the newest of them was made, s on the clock of the walk.
    """

    device: str
    blocks: tuple[SensorBlock, ...]
    made_s: float


class TrackingThread:
    """Thread that feeds a tracker.

    Parameters
    ----------
    config
        Configuration of the tracker.
    expected
        Devices that are known beforehand.
    on_updates
        Called with new estimates, and `made_s` of the samples that released them; None for a fix and at the end.
    on_note
        Called with what the tracker warns of.
    on_end
        Called when everything has been processed.
    plan
        Floor plan of the walk.

    Attributes
    ----------
    height
        Height and floor of the walker at present; None without air pressure.
    """

    def __init__(
        self,
        config: Config,
        expected: Sequence[ExpectedDevice],
        on_updates: Callable[[Sequence[Update], float | None], None],
        on_note: Callable[[str], None],
        on_end: Callable[[], None],
        plan: FloorPlan | BuildingPlan | None = None,
    ) -> None:
        self._tracker = Tracker(config, list(expected), plan=plan)
        self._queue: queue.Queue[LiveSamples | PositionFix | None] = queue.Queue()
        self._on_updates, self._on_note, self._on_end = on_updates, on_note, on_end
        self.height: WalkerHeight | None = None
        self._thread = threading.Thread(target=self._work, name="tracker", daemon=True)

    def start(self) -> None:
        """Begin to work."""
        self._thread.start()

    @property
    def latency_s(self) -> float:
        """Return the declared latency of the tracker, s."""
        return self._tracker.latency_s

    @property
    def waiting(self) -> int:
        """Return the number of inputs that have not been processed yet."""
        return self._queue.qsize()

    def put(self, item: LiveSamples | PositionFix | None) -> None:
        """Add an input; None ends the walk."""
        self._queue.put(item)

    def _work(self) -> None:
        while (item := self._queue.get()) is not None:
            self._process(item)
        self._process(None)
        self._on_end()

    def _process(self, item: LiveSamples | PositionFix | None) -> None:
        updates: list[Update] = []
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                if item is None:
                    updates = self._tracker.flush()
                elif isinstance(item, PositionFix):
                    updates = self._tracker.push_fix(item)
                else:
                    for block in item.blocks:
                        updates += self._tracker.push(item.device, block)
            except PdrError as error:
                self._on_note(str(error))
        self.height = self._tracker.height
        for warning in caught:
            self._on_note(str(warning.message))
        for update in updates:
            for finding in update.findings:
                if finding.doubtful:
                    self._on_note(finding.words)
        if updates:
            self._on_updates(updates, item.made_s if isinstance(item, LiveSamples) else None)
