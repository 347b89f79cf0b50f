"""One live walk: samples of any number of phones come in, poses go out, and everything received is recorded.

Receivers call `take` from any thread; it records the samples. The filter has its own thread and delays nothing.
"""

import gc
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pdr_est.config import Config
from pdr_est.errors import PdrError, RecordingError
from pdr_est.live.limits import LiveLimits, SampleBudget
from pdr_est.live.phones import PhoneMonitor, Source
from pdr_est.live.poses import PoseHistory, height_row
from pdr_est.live.recording_files import LiveRecording
from pdr_est.live.tracking import LiveSamples, TrackingThread
from pdr_est.online import ExpectedDevice, Update
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan
from pdr_est.types.measurements import PositionFix
from pdr_est.types.sensors import SensorBlock

Message = dict[str, Any]
"""Message for a page, which becomes JSON."""

SYNC_EVERY_S = 1.0
"""Time after which at the latest the disk holds what was received, s."""

_MOST_NOTES = 200
_FIX_SIGMA_RANGE_M = (0.05, 100.0)


class LiveSession:
    """A walk that is tracked and recorded while it happens.

    Parameters
    ----------
    config
        Configuration of the tracker.
    recording
        Files that everything received goes to; None to record nothing, as for a replay.
    limits
        Limits of what a phone may send.
    expected
        Devices that are known beforehand.
    epoch_s
        Unix time of time zero, s; None for now.
    plan
        Floor plan of the walk, or those of several floors; None without any.

    Attributes
    ----------
    before_end
        Functions that hand on what receivers hold back, called before the walk ends.
    ended
        Set when everything has been processed and the recording is closed.
    """

    def __init__(
        self,
        config: Config,
        recording: LiveRecording | None,
        limits: LiveLimits | None = None,
        expected: Sequence[ExpectedDevice] = (),
        epoch_s: float | None = None,
        plan: FloorPlan | BuildingPlan | None = None,
    ) -> None:
        self.limits = limits or LiveLimits()
        self.recording = recording
        self.epoch_s = time.time() if epoch_s is None else epoch_s
        self._zero_s = time.monotonic() - (time.time() - self.epoch_s)
        self.plan = plan
        self._tracking = TrackingThread(config, expected, self._show, self.tell, self._end, plan)
        self._lock = threading.RLock()
        self._phones: dict[str, PhoneMonitor] = {}
        self._budgets: dict[str, SampleBudget] = {}
        self._listeners: list[Callable[[Message], None]] = []
        self._history = PoseHistory()
        self._fixes: list[list[float]] = []
        self._notes: dict[str, None] = {}
        self._state, self._ending = "walking", False
        self._report: str | None = None
        self._replayed_s: float | None = None  # data time of a replay
        self.ended = threading.Event()
        self.before_end: list[Callable[[], None]] = []

    def start(self) -> None:
        """Begin to track. What is loaded is kept out of garbage collection, which would delay poses by 100 ms."""
        gc.collect()
        gc.freeze()
        self._tracking.start()
        threading.Thread(target=self._sync_repeatedly, name="sync", daemon=True).start()

    @property
    def now_s(self) -> float:
        """Return the present time on the clock of the walk, s."""
        return time.monotonic() - self._zero_s

    @property
    def data_time_s(self) -> float:
        """Return the time of samples that are made now, s: the present time, or the time in a replay."""
        return self.now_s if self._replayed_s is None else self._replayed_s

    @property
    def latency_s(self) -> float:
        """Return the declared latency of the tracker, s."""
        return self._tracking.latency_s

    @property
    def waiting(self) -> int:
        """Return the number of inputs that wait for the filter."""
        return self._tracking.waiting

    def join(self, source: Source, name: str | None = None) -> PhoneMonitor:
        """Add a phone.

        Parameters
        ----------
        source
            Way in which its samples arrive.
        name
            Its name; None to give it one.

        Raises
        ------
        RecordingError
            If there are as many phones as the limits allow.
        """
        with self._lock:
            if len(self._phones) >= self.limits.phones:
                most = f"{self.limits.phones} phone{'' if self.limits.phones == 1 else 's'}"
                raise RecordingError(f"this walk takes no more than {most}: start another one for more")
            number = len(self._phones) + 1
            phone = PhoneMonitor(name or ("phone" if number == 1 else f"phone-{number}"), source)
            self._phones[phone.name] = phone
            self._budgets[phone.name] = SampleBudget(self.limits)
            return phone

    def take(self, phone: PhoneMonitor, blocks: Sequence[SensorBlock]) -> None:
        """Record samples of a phone and hand them to the filter; nothing happens once the walk has ended.

        Raises
        ------
        RecordingError
            If the phone sends more than the limits allow.
        OutputError
            If the samples cannot be written.
        """
        blocks = tuple(block for block in blocks if len(block.time_s))
        with self._lock:
            if not blocks or self._state != "walking":
                return
            if not self._budgets[phone.name].take(sum(len(block.time_s) for block in blocks), time.monotonic()):
                raise RecordingError(
                    f"{phone.name}: more than {self.limits.samples_per_s:g} samples a second: choose a lower rate"
                )
            if self.recording is not None:
                self.recording.add(phone.name, blocks)
                if self.recording.size_bytes > self.limits.walk_bytes:
                    self.tell(f"the recording has reached {self.limits.walk_bytes >> 20} MiB: the walk has ended")
                    threading.Thread(target=self.stop).start()
            newest_s = max(float(block.time_s[-1]) for block in blocks)
            self._replayed_s = newest_s if phone.source == "replay" else None
            phone.note(blocks, self.data_time_s)
        if self.waiting < self.limits.waiting_blocks:
            made_s = self.now_s if phone.source == "replay" else newest_s
            self._tracking.put(LiveSamples(phone.name, blocks, made_s))
        else:
            self.tell("this computer is too slow to follow: samples are recorded, but the track here has gaps")

    def keep_message(self, text: str) -> None:
        """Record a message of an app as it came."""
        with self._lock:
            if self.recording is not None and not self._ending:
                self.recording.add_message(text)

    def take_fix(self, x_m: float, y_m: float, sigma_m: float, time_s: float) -> None:
        """Take the position that the walker states; raises RecordingError for values that are no position.

        Parameters
        ----------
        x_m, y_m, sigma_m
            East and north with the standard deviation of each, m.
        time_s
            Time at which the walker was there, s.
        """
        low, high = _FIX_SIGMA_RANGE_M
        if not (np.isfinite([x_m, y_m, time_s]).all() and low <= sigma_m <= high and max(abs(x_m), abs(y_m)) < 1e7):
            raise RecordingError(
                f"a position of ({x_m:g}, {y_m:g}) m within {sigma_m:g} m at {time_s:g} s: give finite numbers, with "
                f"a standard deviation of {low:g} to {high:g} m"
            )
        self.put_fix(PositionFix(time_s, np.array([x_m, y_m]), sigma_m**2 * np.eye(2), "user", robust=True))

    def put_fix(self, fix: PositionFix) -> None:
        """Record a known position and hand it to the filter. Raises OutputError if it cannot be written."""
        with self._lock:
            if self._state != "walking":
                return
            if self.recording is not None:
                self.recording.add_fix(fix)
            (xx, xy), (_, yy) = fix.covariance_m2.tolist()
            row = [fix.time_s, *fix.position_m.tolist(), xx, xy, yy]
            self._fixes.append(row)
        self._publish({"type": "fixes", "fixes": [row]})
        self._tracking.put(fix)

    def stop(self) -> bool:
        """End the walk: what waits is processed, then `ended` is set. Return False if it was ended before."""
        with self._lock:
            if self._ending:
                return False
            self._ending = True
        for work in self.before_end:  # without the lock, which the other threads of a receiver may wait for
            work()
        with self._lock:
            self._state = "ending"
        self._tracking.put(None)
        self._publish({"type": "state", "state": "ending"})
        return True

    def tell(self, words: str) -> None:
        """Show a note on the pages, once."""
        with self._lock:
            fresh = words not in self._notes and len(self._notes) < _MOST_NOTES
            self._notes |= {words: None} if fresh else {}
        if fresh:
            self._publish({"type": "notes", "notes": [words]})

    def report_ready(self, address: str | None) -> None:
        """Tell the pages where the report is; None if there is none."""
        self._state, self._report = "ended", address
        self._publish({"type": "state", "state": "ended", "report": address})

    def listen(self, listener: Callable[[Message], None]) -> list[Message]:
        """Call a function, from any thread, with every message from now on; return messages with all before."""
        with self._lock:
            self._listeners.append(listener)
            return [
                {"type": "poses", "poses": self._history.rows()},
                {"type": "fixes", "fixes": self._fixes},
                {"type": "notes", "notes": list(self._notes)},
                {"type": "state", "state": self._state, "report": self._report},
                self.status(),
            ]

    def unlisten(self, listener: Callable[[Message], None]) -> None:
        """Call a function no more."""
        with self._lock:
            self._listeners = [one for one in self._listeners if one != listener]

    def status(self) -> Message:
        """Describe phones, sensors and what is missing."""
        with self._lock:
            now_s = self.data_time_s
            missing = [words for phone in self._phones.values() for words in phone.missing(now_s)]
            if not self._phones:
                missing = ["no phone yet: open this page on a phone, or let an app send here"]
            return {
                "type": "status",
                "latency_s": round(self.latency_s, 3),
                "height": height_row(self._tracking.height),
                "phones": [phone.as_json(now_s, self._history.steps(phone.name)) for phone in self._phones.values()],
                "missing": missing if self._state == "walking" else [],
            }

    def _publish(self, message: Message) -> None:
        for listener in list(self._listeners):
            listener(message)

    def _show(self, updates: Sequence[Update], made_s: float | None) -> None:
        """Publish new estimates."""
        with self._lock:
            rows = self._history.add(updates)
        if rows:
            self._publish({"type": "poses", "poses": rows, "made_s": made_s})

    def _end(self) -> None:
        """Close the recording when the filter has finished."""
        self._sync()
        with self._lock:
            if self.recording is not None:
                self.recording.close()
        self.ended.set()

    def _sync_repeatedly(self) -> None:
        while not self.ended.wait(SYNC_EVERY_S):
            self._sync()

    def _sync(self) -> None:
        """Bring the recording to the disk, for which the filter does not wait."""
        try:
            if self.recording is not None:
                self.recording.sync()
        except PdrError as error:
            self.tell(str(error))
