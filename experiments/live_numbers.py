"""Numbers of the live page: delay, memory, and what a killed server loses.

Run: python experiments/live_numbers.py [delay|memory|kills ...] [--seconds 120] [--minutes 30] [--kills 20] [-o FILE]
Starts `pdr-est live` and feeds it with a simulated walk of two phones at 100 Hz, in messages of 20 ms as the page of
a phone sends them.

delay   from the moment at which the sample was made that releases a pose, to the frame of a headless Chromium that
        shows the pose; the filter's own declared latency, which it waits for samples, is therefore not in it
memory  resident memory of the server while a recording is replayed as fast as the filter follows, with a page open
kills   the server is killed (SIGKILL) at random moments: seconds from the last sample in the recording that it leaves
        to the last one that was sent
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import numpy as np
from websockets.sync.client import ClientConnection, connect

from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.io.formats.registry import read
from pdr_est.performance.online import walk_in_rounds
from pdr_est.types.recording import DeviceRecording, Recording

RESULT = Path(__file__).resolve().parent / "results" / "live_numbers.txt"
MESSAGE_S = 0.02
ROUNDS_FOR = 1.15  # the walkers of `walk_in_rounds` need less time than it is told
CHROMIUM = ("/usr/bin/chromium", "/usr/bin/google-chrome")


@contextmanager
def server(*options: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Run the command; give its process and the address of its page."""
    call = (sys.executable, "-m", "pdr_est", "live", "--port", "0", *options)
    with subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        try:
            yield process, process.stdout.readline().removeprefix("page: ").strip()
        finally:
            process.kill()


def link(address: str) -> ClientConnection:
    return connect(address.replace("http", "ws") + "link", proxy=None, max_size=None)


class Sender(threading.Thread):
    """A phone: sends rows as they are made, until it is told to stop or the connection breaks."""

    def __init__(self, address: str, device: DeviceRecording) -> None:
        super().__init__(daemon=True)
        self._connection, self._halted = link(address), threading.Event()
        self._page = self._connection.__enter__()
        force, rate = device.specific_force, device.rotation_rate
        self._rows = np.column_stack(
            [force.time_s - force.time_s[0], force.values, np.degrees(rate.interpolated_at(force.time_s))]
        )
        self._page.send(json.dumps({"type": "phone", "id": device.name}))
        self._zero_s = self._clock()
        self.last_s = float("nan")

    def _clock(self) -> float:
        """Time of the walk when time.monotonic() is zero, s."""
        best = (np.inf, 0.0)
        for _ in range(5):
            sent_s = time.monotonic()
            self._page.send(json.dumps({"type": "ping", "sent": 0}))
            while (pong := json.loads(self._page.recv()))["type"] != "pong":
                pass
            took_s = time.monotonic() - sent_s
            best = min(best, (took_s, pong["now_s"] - sent_s - took_s / 2.0))
        return best[1]

    def run(self) -> None:
        begun_s, done = time.monotonic(), 0
        rows = self._rows.copy()
        rows[:, 0] += begun_s + self._zero_s
        threading.Thread(target=self._drain, daemon=True).start()
        try:
            while done < len(rows) and not self._halted.wait(MESSAGE_S):
                upto = int(np.searchsorted(self._rows[:, 0], time.monotonic() - begun_s))
                if upto > done:
                    self._page.send(json.dumps({"type": "motion", "rows": rows[done:upto].tolist()}))
                    self.last_s, done = float(rows[upto - 1, 0]), upto
        except OSError:
            return
        except Exception as error:  # the connection breaks when the server is killed
            if "Closed" not in type(error).__name__:
                raise

    def _drain(self) -> None:
        try:
            for _ in self._page:
                pass
        except Exception:
            return

    def stop(self) -> None:
        self._halted.set()
        self.join(5.0)
        with suppress(Exception):  # of a server that was killed
            self._connection.__exit__(None, None, None)


def delay(seconds: float, walk: Recording) -> Iterator[str]:
    """Stream two phones to a server whose page a browser shows."""
    from playwright.sync_api import sync_playwright

    chromium = next(path for path in CHROMIUM if Path(path).exists())
    with tempfile.TemporaryDirectory() as folder, server("-o", f"{folder}/out") as (_, address), ExitStack() as stack:
        playwright = stack.enter_context(sync_playwright())
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page()
        page.goto(address)
        senders = [Sender(address, device) for device in walk.devices]
        for sender in senders:
            sender.start()
        page.wait_for_timeout(1000.0 * seconds)
        delays_ms, poses = page.evaluate("[liveDelays, liveTrack.rows('fused').length]")
        browser.close()
        for sender in senders:
            sender.stop()
    quantiles = np.percentile(delays_ms, [50, 95, 99, 100])
    yield f"delay: {seconds:g} s, two phones at 100 Hz, {len(delays_ms)} messages, {poses} poses of the person"
    yield "  sample to drawn pose, ms: median {:.0f}, p95 {:.0f}, p99 {:.0f}, largest {:.0f}".format(*quantiles)


def memory(walk: Recording) -> Iterator[str]:
    """Replay a long recording as fast as possible, with a page that listens."""
    with tempfile.TemporaryDirectory() as folder:
        options = []
        for device in walk.devices:
            path = Path(folder) / f"{device.name}.csv"
            write_plain_csv(Recording(device.name, "simulated", (device,)), path)
            options += ["--replay", str(path)]
        with server("-o", f"{folder}/out", "--speed", "1000", *options) as (process, address), link(address) as page:
            begin_s, end_s = walk.span_s
            lasts = f"{(end_s - begin_s) / 60.0:.0f} minutes"
            yield f"memory: {lasts}, two phones at 100 Hz, replayed as fast as the filter follows"
            begun_s, due_s, now_s = time.monotonic(), 60.0, 0.0
            for text in page:
                message = json.loads(text)
                if message["type"] == "poses":
                    now_s = max([now_s, *(row[1] for row in message["poses"])])
                    if now_s >= due_s:
                        yield f"  minute {now_s / 60.0:4.1f}: {resident_mb(process.pid):.1f} MB"
                        due_s += 300.0 if due_s >= 300.0 else 240.0
                if message["type"] == "state" and message["state"] != "walking":
                    break
            took_s = time.monotonic() - begun_s
            yield f"  end, minute {now_s / 60.0:4.1f}: {resident_mb(process.pid):.1f} MB, after {took_s:.0f} s"


def resident_mb(pid: int) -> float:
    status = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    return float(next(line for line in status.splitlines() if line.startswith("VmRSS:")).split()[1]) / 1024.0


def kills(count: int, walk: Recording) -> Iterator[str]:
    """Kill servers at random moments."""
    moments = random.Random(5)
    lost_s = []
    for _ in range(count):
        with tempfile.TemporaryDirectory() as folder, server("-o", f"{folder}/out") as (process, address):
            senders = [Sender(address, device) for device in walk.devices]
            for sender in senders:
                sender.start()
            time.sleep(moments.uniform(0.5, 6.0))
            process.send_signal(signal.SIGKILL)
            process.wait()
            for sender, name in zip(senders, ("phone", "phone-2"), strict=True):
                sender.stop()
                device = read(Path(folder) / "out" / f"{name}.csv").devices[0]
                lost_s.append(sender.last_s - min(signal.time_s[-1] for signal in device.signals().values()))
    yield f"kills: {count} servers killed, two phones each, every recording read"
    yield f"  lost at the end, s: median {np.median(lost_s):.3f}, largest {max(lost_s):.3f}"


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", default=("delay", "memory", "kills"))
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("-o", "--output", type=Path, default=RESULT)
    options = parser.parse_args(arguments)
    parts: dict[str, Callable[[], Iterator[str]]] = {
        "delay": lambda: delay(options.seconds, walk_in_rounds(options.seconds / 60.0 + 1.0)),
        "memory": lambda: memory(walk_in_rounds(ROUNDS_FOR * options.minutes)),
        "kills": lambda: kills(options.kills, walk_in_rounds(1.0)),
    }
    settings = f"--seconds {options.seconds:g} --minutes {options.minutes:g} --kills {options.kills}"
    lines = [f"python experiments/live_numbers.py {' '.join(options.parts)} {settings}; {os.cpu_count()} cores"]
    for part in options.parts:
        for line in parts[part]():
            print(line, flush=True)
            lines.append(line)
    options.output.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
