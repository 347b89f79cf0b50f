"""Draw the pictures of the README and the docs from simulated walks.

    python experiments/readme_pictures.py [--browser chromium]

Writes docs/pictures/steps.png, track.png and two-phones.png. With a Chromium-like browser also report.png, the upper
part of the report that `make demo` writes, and live.png, the live page while two phones are replayed.
"""

import argparse
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from pdr_est import pipeline
from pdr_est.cli import main as pdr_est
from pdr_est.config import Config, StartParams
from pdr_est.estimators.person.track import NAME
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.pipeline import SmoothedWalk
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.acceleration import plot_acceleration
from pdr_est.report.plots.time_axis import time_axis
from pdr_est.report.plots.track import plot_track
from pdr_est.simulate import Scenario, SensorParams, SimulatedWalk, mmpdr_indoor, preset, sample_person, simulate_walk
from pdr_est.simulate.people.carried_device import carried_device
from pdr_est.types.measurements import PositionFix
from pdr_est.types.steps import CarryingMode

PICTURES = Path(__file__).resolve().parents[1] / "docs" / "pictures"
KNOWN_START = StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0, sigma_position_m=0.1, sigma_heading_rad=0.02)
HOLDING, SWING, POCKET = CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET
SEED = 0
SIGMA_M = 0.5
DPI = 100
REPORT_SIZE = (1000, 1066)  # pixels: header and track
LIVE_SIZE = (900, 1160)  # pixels: map, numbers and sensors
LIVE_STEPS = 240


def main() -> None:
    """Write all pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--browser", help="program that takes a screenshot of the report")
    browser = parser.parse_args().browser
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name, figure in (("steps", steps()), ("track", track_with_fixes()), ("two-phones", two_phones())):
        figure.patch.set_visible(True)
        figure.set_facecolor("white")
        figure.savefig(PICTURES / f"{name}.png", dpi=DPI, metadata={"Software": None})
    if browser:
        photograph_report(browser, PICTURES / "report.png")
        photograph_live_page(browser, PICTURES / "live.png")


def photograph_report(browser: str, picture: Path) -> None:
    """Take a screenshot of the demo's report, with few colours so that it stays small."""
    with tempfile.TemporaryDirectory() as folder:
        pdr_est(["demo", "-o", f"{folder}/demo", "--quiet"], standalone_mode=False)
        size = ",".join(str(pixels) for pixels in REPORT_SIZE)
        options = ("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--window-size={size}")
        options += ("--virtual-time-budget=3000",)  # the map is drawn by scripts
        shot = Path(folder) / "shot.png"
        subprocess.run((browser, *options, f"--screenshot={shot}", f"file://{folder}/demo/report.html"), check=True)
        save_small(shot, picture)


def photograph_live_page(browser: str, picture: Path) -> None:
    """Replay the walk with two phones, and take a screenshot of the live page when the walk is half over."""
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        recording = simulate_walk(with_two_phones(SEED)).recording
        call = [sys.executable, "-m", "pdr_est", "live", "--port", "0", "--speed", "2", "-o", f"{folder}/live"]
        for one in recording.devices:
            write_plain_csv(replace(recording, devices=(one,)), Path(folder) / f"{one.name}.csv")
            call += ["--replay", f"{folder}/{one.name}.csv"]
        with subprocess.Popen(call, stdout=subprocess.PIPE, text=True) as live:
            try:
                address = (live.stdout.readline() if live.stdout else "").removeprefix("page: ").strip()
                chromium = playwright.chromium.launch(executable_path=browser, args=["--no-sandbox"])
                page = chromium.new_page(viewport={"width": LIVE_SIZE[0], "height": LIVE_SIZE[1]})
                page.goto(address)
                while page.evaluate("liveTrack.rows('fused').length") < LIVE_STEPS:
                    page.wait_for_timeout(200)
                page.wait_for_timeout(600)  # the map is drawn again a little later
                page.screenshot(path=f"{folder}/shot.png")
                chromium.close()
            finally:
                live.kill()
        save_small(Path(folder) / "shot.png", picture)


def save_small(shot: Path, picture: Path) -> None:
    """Save a screenshot with few colours."""
    Image.open(shot).convert("P", palette=Image.Palette.ADAPTIVE, colors=128).save(picture, optimize=True)


def steps() -> Figure:
    """Draw the detected steps of a phone that goes from the hand into a pocket."""
    walk, _ = smoothed(simulate_walk(mmpdr_indoor(HOLDING, POCKET, seed=1)))
    return plot_acceleration(walk.devices[0], time_axis(walk), svg.device_colour(0))


def track_with_fixes() -> Figure:
    """Draw the office loop of the demo with a known start and two fixes."""
    simulated = simulate_walk(preset("office_loop"))
    end_s = float(simulated.truth_time_s[-1])
    walk, truth_m = smoothed(simulated, (0.33 * end_s, 0.66 * end_s))
    return plot_track(walk.track, walk.fixes, truth_m)


def two_phones() -> Figure:
    """Draw the tracks of a swinging phone and of one in a pocket, each alone, and of the person from both."""
    simulated = simulate_walk(with_two_phones(SEED))
    recording, reckoned = simulated.recording, replace(Config(), start=KNOWN_START).with_estimator("dead-reckoning")
    alone = [
        pipeline.smooth_recording(replace(recording, devices=(one,)), reckoned).track for one in recording.devices
    ]
    walk, truth_m = smoothed(simulated)
    person = walk.track.of_device(NAME)
    figure = svg.new_figure(5.6)
    axes = svg.add_axes(figure, 0.6, 4.9)
    axes.plot(*truth_m.T, color=svg.INK, linewidth=1.2, linestyle="--", label="truth")
    for number, track in enumerate(alone):
        words = f"{track.device[0]} alone"
        axes.plot(*track.position_m.T, color=svg.device_colour(number), linewidth=1.6, label=words)
    axes.plot(*person.position_m.T, color=svg.device_colour(2), linewidth=3.0, label="person, from both")
    axes.set_aspect("equal", adjustable="datalim")
    svg.label_axes(axes, "east (m)", "north (m)")
    axes.legend(frameon=False, labelcolor=svg.INK, fontsize=9.0, loc="center")
    return figure


def with_two_phones(seed: int) -> Scenario:
    """Simulate the office loop with one phone in the swinging hand and another one in a pocket."""
    rng = np.random.default_rng(seed)
    person = sample_person(rng)
    carried = [
        carried_device(person, (mode,), (), rng, SensorParams(rate_hz=50.0), name)
        for name, mode in (("hand", SWING), ("pocket", POCKET))
    ]
    loop = preset("office_loop")
    return replace(loop, gait=person.gait, body=person.body, devices=tuple(carried), seed=seed)


def smoothed(simulated: SimulatedWalk, fixes_s: tuple[float, ...] = ()) -> tuple[SmoothedWalk, np.ndarray]:
    """Simulate the walk with a known start and fixes at some times; return also its true positions (n, 2)."""
    rng = np.random.default_rng(0)
    covariance_m2 = SIGMA_M**2 * np.eye(2)
    fixes = []
    for time_s in fixes_s:
        true_m = np.array(
            [np.interp(time_s, simulated.truth_time_s, column) for column in simulated.truth_position_m.T]
        )
        fixes.append(PositionFix(time_s, true_m + SIGMA_M * rng.standard_normal(2), covariance_m2))
    config = replace(Config(), start=KNOWN_START)
    return pipeline.smooth_recording(simulated.recording, config, fixes), simulated.truth_position_m


if __name__ == "__main__":
    main()
