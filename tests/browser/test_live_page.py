"""The live page in a real browser, fed by a replay and by the browser's own motion events."""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page
from storeys import BUILDING, over_three_storeys

from pdr_est.config import Config
from pdr_est.io.floor_plans.writing import write_floor_plan
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.io.formats.registry import read
from pdr_est.pipeline import smooth_recording
from pdr_est.simulate import preset, simulate_walk

PATIENCE_MS = 90_000
WALKING = "Boolean(liveTrack.main()) && liveTrack.rows(liveTrack.main()).length > 5"
ROWS = "(name) => liveTrack.rows(name)"


@contextmanager
def live_server(*options: str) -> Iterator[str]:
    """Run `pdr-est live` on a free port; give the address of its page."""
    call = (sys.executable, "-m", "pdr_est", "live", "--port", "0", *options)
    with subprocess.Popen(call, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            line = process.stdout.readline()
            assert line.startswith("page: "), line
            yield line.removeprefix("page: ").strip()
        finally:
            process.kill()


def wait_until(page: Page, expression: str) -> None:
    """Wait for a value of the page; Playwright's own waiting needs `eval`, which the page's policy forbids."""
    for _ in range(PATIENCE_MS // 100):
        if page.evaluate(expression):
            return
        page.wait_for_timeout(100)
    raise AssertionError(expression)


def fits_width(page: Page) -> bool:
    return bool(page.evaluate("document.documentElement.scrollWidth <= window.innerWidth"))


def same_track(rows: list[list[float]], track: object, name: str) -> None:
    """The page has the poses of the track, to the tenth of a millimetre that it gets."""
    one = track.of_device(name)
    np.testing.assert_allclose([row[1] for row in rows], one.time_s, atol=1e-6)
    np.testing.assert_allclose([row[3:5] for row in rows], one.position_m, atol=1e-4)
    np.testing.assert_allclose([row[5] for row in rows], one.covariance_m2[:, 0, 0], rtol=1e-3, atol=1e-6)


def test_a_replay_grows_ends_and_shows_its_report(tmp_path: Path, open_page: Callable[..., Page]) -> None:
    walk = tmp_path / "walk.csv"
    write_plain_csv(simulate_walk(preset("l_shape")).recording, walk)
    with live_server("--replay", str(walk), "--speed", "8", "-o", str(tmp_path / "out")) as address:
        page = open_page(address, width=390, height=844)
        wait_until(page, WALKING)
        assert page.locator("#phones").inner_text().startswith("device")
        assert "accelerometer" in page.locator("#phones").inner_text()
        assert fits_width(page)
        page.wait_for_selector("#report:not([hidden])", timeout=PATIENCE_MS)
        frame = page.frame_locator("#report-frame")
        assert "pedestrian track" in (frame.locator("title").first.text_content() or "")
        assert fits_width(page)
        recording = read(walk)
        whole = smooth_recording(recording, Config().with_estimator("ekf"))
        same_track(page.evaluate(ROWS, "device"), whole.track, "device")
        assert page.locator("#steps").inner_text() == str(len(whole.track) - 1)


@pytest.mark.slow
def test_the_walker_states_a_position(tmp_path: Path, open_page: Callable[..., Page]) -> None:
    walk = tmp_path / "walk.csv"
    write_plain_csv(simulate_walk(preset("l_shape")).recording, walk)
    with live_server("--replay", str(walk), "--speed", "2", "-o", str(tmp_path / "out")) as address:
        page = open_page(address)
        wait_until(page, WALKING)
        before = page.locator("#radius").inner_text()
        page.locator("#sigma").fill("0.2")
        page.locator("#here").click()
        page.locator("#map").click(position={"x": 200, "y": 150})
        wait_until(page, "liveTrack.fixes().length === 1")
        fix = page.evaluate("liveTrack.fixes()[0]")
        assert fix["cxx_m2"] == pytest.approx(0.04)
        assert before
        page.on("dialog", lambda dialog: dialog.accept())
        page.locator("#stop").click()
        page.wait_for_selector("body[data-state=ended]", timeout=PATIENCE_MS)


@pytest.mark.slow
def test_a_phone_too_many_is_told_and_may_still_state_positions(
    tmp_path: Path, open_page: Callable[..., Page]
) -> None:
    """A replay has all its phones: the page says so, keeps its connection, and refuses an impossible deviation."""
    walk = tmp_path / "walk.csv"
    write_plain_csv(simulate_walk(preset("l_shape")).recording, walk)
    with live_server("--replay", str(walk), "-o", str(tmp_path / "out")) as address:
        page = open_page(address, width=390, height=844)
        wait_until(page, WALKING)
        page.locator("#sensors").click()
        wait_until(page, "document.getElementById('phone-state').textContent.includes('no more than 1 phone')")
        page.locator("#sigma").fill("500")
        page.locator("#here").click()
        assert page.locator("#here-hint").is_hidden()
        page.locator("#sigma").fill("0.5")
        page.locator("#here").click()
        page.locator("#map").click(position={"x": 150, "y": 150})
        wait_until(page, "liveTrack.fixes().length === 1")
        assert page.locator("#state").inner_text() == "connected"


EVENTS = """
([times, forces, rates, rate_hz]) => {
  let begun = null;
  const between = (rows, t) => {
    let i = times.findIndex((one) => one > t);
    i = i < 0 ? times.length - 1 : Math.max(i, 1);
    const share = Math.min(Math.max((t - times[i - 1]) / (times[i] - times[i - 1]), 0), 1);
    return rows[i].map((value, k) => rows[i - 1][k] + share * (value - rows[i - 1][k]));
  };
  window.walked = false;
  const timer = setInterval(() => {
    const now = performance.now();
    begun = begun === null ? now : begun;
    const t = times[0] + (now - begun) / 1000;
    if (t > times[times.length - 1]) { clearInterval(timer); window.walked = true; return; }
    const [x, y, z] = between(forces, t);
    const [alpha, beta, gamma] = between(rates, t).map((value) => value * 180 / Math.PI);
    window.dispatchEvent(new DeviceMotionEvent('devicemotion', {
      accelerationIncludingGravity: { x, y, z }, rotationRate: { alpha, beta, gamma }, interval: 1000 / rate_hz,
    }));
  }, 1000 / rate_hz);
}
"""


@pytest.mark.slow
def test_the_browsers_own_sensors_make_the_track_of_the_file(tmp_path: Path, open_page: Callable[..., Page]) -> None:
    """Motion events at 60 Hz for as long as the walk takes: the page shows what ekf makes of the recording."""
    device = simulate_walk(preset("office_loop")).recording.devices[0]
    force, rate = device.specific_force, device.rotation_rate
    assert force is not None
    assert rate is not None
    until = force.time_s < force.time_s[0] + 60.0
    signal = [
        force.time_s[until].tolist(),
        force.values[until].tolist(),
        rate.interpolated_at(force.time_s[until]).tolist(),
    ]
    out = tmp_path / "out"
    with live_server("-o", str(out)) as address:
        page = open_page(address)
        wait_until(page, "Number.isFinite(link.now_s())")
        page.locator("#sensors").click()
        wait_until(page, "document.getElementById('phone-state').textContent.includes('phone')")
        page.evaluate(EVENTS, [*signal, 60])
        wait_until(page, "window.walked")
        page.wait_for_timeout(500)
        page.on("dialog", lambda dialog: dialog.accept())
        page.locator("#stop").click()
        page.wait_for_selector("#report:not([hidden])", timeout=PATIENCE_MS)
        rows, delays = page.evaluate(ROWS, "phone"), page.evaluate("liveDelays")
    recording = read(out / "phone.csv")
    recorded = recording.devices[0].specific_force
    assert recorded is not None
    assert len(recorded) / (recorded.time_s[-1] - recorded.time_s[0]) == pytest.approx(60.0, abs=8.0)
    track = smooth_recording(recording, Config().with_estimator("ekf")).track
    assert len(rows) > 60
    same_track(rows, track, track.devices[0])
    assert np.median(delays) < 200.0
    assert (out / "result" / "report.html").is_file()


def test_the_plan_of_the_present_floor_lies_below_the_track(tmp_path: Path, open_page: Callable[..., Page]) -> None:
    walk, floors = tmp_path / "walk.csv", [tmp_path / f"{plan.floor}.geojson" for plan in BUILDING.plans]
    write_plain_csv(over_three_storeys().recording, walk)
    for plan, file in zip(BUILDING.plans, floors, strict=True):
        write_floor_plan(plan, file)
    plans = [word for file in floors for word in ("--plan", str(file))]
    start = ("--start", "0", "0", "--heading", "0", "--floor", "0")
    options = ("--replay", str(walk), "--speed", "25", "-o", str(tmp_path / "out"), *plans, *start)
    shown = "livePlans.filter(({ layer }) => liveMap.leaflet.hasLayer(layer)).map(({ name }) => name).join()"
    with live_server(*options) as address:
        page = open_page(address, width=390, height=844, color_scheme="dark")
        wait_until(page, WALKING)
        assert page.evaluate(shown) == "0"
        for floor in ("1", "2", "1"):
            wait_until(page, f"{shown} === '{floor}'")
        assert page.locator("#floor").inner_text().startswith("1, +")
        assert fits_width(page)
        page.wait_for_selector("#report:not([hidden])", timeout=PATIENCE_MS)
        rows = page.evaluate("liveTrack.rows(liveTrack.main())")
    summary = json.loads((tmp_path / "out" / "result" / "summary.json").read_text(encoding="utf-8"))
    assert [one["floor"] for one in summary["floor_plans"]] == ["0", "1", "2"]
    last_m = np.array([row[3:5] for row in rows if row[1] > rows[-1][1] - 10.0])
    assert BUILDING.plans[1].contains(last_m).mean() > 0.9
