"""The report of a walk in a real browser."""

import base64
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page, Route, expect
from storeys import BUILDING, TURNED, over_three_storeys

from pdr_est import pipeline
from pdr_est.cli import main
from pdr_est.config import Config, StartParams
from pdr_est.report.background.reading import read_background
from pdr_est.report.walk.result_files import write_results
from pdr_est.simulate import preset, simulate_walk
from pdr_est.types.recording import GeoOrigin
from pdr_est.types.region import PoseRegion

OpenPage = Callable[..., Page]
ONE_PIXEL = "R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7"


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Address of the report of the demo with a fix that is known and a plan below the track."""
    folder = tmp_path_factory.mktemp("report")
    assert main(["demo", "-o", str(folder / "demo"), "-q"], standalone_mode=False) in (None, 0)
    walk = folder / "demo" / "simulated-walk.csv"
    simulated = simulate_walk(preset("office_loop"))
    places_m = [np.interp((10.0, 60.0, 100.0), simulated.truth_time_s, one) for one in simulated.truth_position_m.T]
    rows = [f"{time_s},{x_m:.2f},{y_m:.2f},0.5" for time_s, x_m, y_m in zip((10, 60, 100), *places_m, strict=True)]
    (folder / "fixes.csv").write_text("\n".join(["time_s,x_m,y_m,sigma_m", *rows, ""]))
    plan = '{"type": "LineString", "coordinate_unit": "metre", "coordinates": [[-5, -5], [30, -5], [30, 20]]}'
    (folder / "plan.geojson").write_text(plan)
    options = ["--fixes", str(folder / "fixes.csv"), "--background", str(folder / "plan.geojson"), "-q"]
    options += ["--format", "tum"]
    assert main(["smooth", str(walk), "-o", str(folder / "out"), *options], standalone_mode=False) in (None, 0)
    return (folder / "out" / "report.html").as_uri()


def cell(page: Page, number: int) -> str:
    return page.locator("#cursor-table tbody td").nth(number).inner_text()


def test_opens_without_an_error_and_shows_no_still_picture(report: str, open_page: OpenPage) -> None:
    page = open_page(report)
    assert "pedestrian track" in page.title()
    assert page.locator("#track-map canvas").count() > 3
    assert page.locator(".chart canvas").count() >= 7
    assert not page.locator(".still svg").first.is_visible()


def test_without_scripts_the_pictures_are_shown(report: str, open_page: OpenPage) -> None:
    page = open_page(report, java_script_enabled=False)
    assert page.locator(".still svg").first.is_visible()
    assert not page.locator("#track-map").is_visible()


def test_in_print_the_pictures_are_shown(report: str, open_page: OpenPage) -> None:
    page = open_page(report)
    page.emulate_media(media="print")
    assert page.locator(".still svg").first.is_visible()
    assert not page.locator("#track-map").is_visible()


def test_a_chart_moves_the_cursor_of_everything(report: str, open_page: OpenPage) -> None:
    page = open_page(report)
    lines = page.locator(".time-line")
    before = [lines.nth(i).evaluate("line => line.style.transform") for i in range(lines.count())]
    place = cell(page, 1)
    over = page.locator(".chart .u-over").nth(2)
    over.scroll_into_view_if_needed()
    over.hover(position={"x": 300, "y": 30})
    after = [lines.nth(i).evaluate("line => line.style.transform") for i in range(lines.count())]
    assert all(one != other for one, other in zip(before, after, strict=True))
    assert cell(page, 1) != place
    assert page.locator(".time-now").inner_text() != "0.0 s"
    assert float(page.locator(".time-slider").input_value()) > 5.0


def numbers_in(text: str) -> list[float]:
    return [float(number.replace("−", "-")) for number in re.findall(r"[−-]?\d+\.\d+", text)]


def pointed_place(page: Page, x: float, y: float) -> list[float]:
    """Point at a pixel of the window; return the place on the map that is shown, m."""
    shown = page.locator(".map-place")
    before = shown.inner_text()
    page.mouse.move(x, y)
    expect(shown).not_to_have_text(before)
    return numbers_in(shown.inner_text())


def test_pointing_at_a_step_on_the_map_shows_it(report: str, open_page: OpenPage) -> None:
    page = open_page(report)
    at_time = "(slider, time) => { slider.value = time; slider.dispatchEvent(new Event('input')); }"
    page.locator(".time-slider").evaluate(at_time, 30)
    there = cell(page, 1)
    page.locator(".time-slider").evaluate(at_time, 0)
    assert cell(page, 1) != there
    page.locator("#track-map").scroll_into_view_if_needed()
    box = page.locator("#track-map").bounding_box()
    assert box is not None
    left, top = box["x"] + 100.0, box["y"] + 100.0
    first = pointed_place(page, left, top)
    second = pointed_place(page, left + 200.0, top + 200.0)
    pixels = [200.0 / (there - here) for here, there in zip(first, second, strict=True)]  # in a metre
    right, down = ((m - here) * scale for m, here, scale in zip(numbers_in(there), first, pixels, strict=True))
    page.mouse.move(left + right, top + down)
    expect(page.locator("#cursor-table tbody td").nth(1)).to_have_text(re.compile(re.escape(there.split(".")[0])))
    found = numbers_in(cell(page, 1))
    assert np.hypot(*np.subtract(found, numbers_in(there))) < 1.0  # the nearest pose, at a place shown to 0.1 m


def test_zoom_of_one_chart_is_that_of_all(report: str, open_page: OpenPage) -> None:
    page = open_page(report)
    over = page.locator(".chart .u-over").first
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 200, box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + 320, box["y"] + 40, steps=4)
    page.mouse.up()
    whole = page.locator("#time-window button", has_text="whole")
    assert whole.get_attribute("aria-pressed") == "false"
    page.locator("#time-window button", has_text="10 s").click()
    assert page.locator("#time-window button", has_text="10 s").get_attribute("aria-pressed") == "true"
    whole.click()
    assert whole.get_attribute("aria-pressed") == "true"


def test_playback_runs_and_stops(report: str, open_page: OpenPage) -> None:
    page = open_page(report)
    page.locator(".play").click()
    page.wait_for_timeout(1000)
    page.locator(".play").click()
    stopped = page.locator(".time-slider").input_value()
    assert 1.0 < float(stopped) < 20.0  # four times as fast as the walk
    page.wait_for_timeout(150)
    assert page.locator(".time-slider").input_value() == stopped


def test_every_toggle_changes_the_map(report: str, open_page: OpenPage) -> None:
    page = open_page(report)
    boxes = page.locator("#map-toggles label")
    assert {"95 % regions", "known positions", "truth", "dead reckoning", "background"} <= set(
        boxes.all_inner_texts()
    )
    drawn = (
        "[...document.querySelectorAll('#track-map canvas')].map((one) => one.toDataURL()).join()"
        " + document.querySelectorAll('#track-map canvas').length"
    )
    for number in range(boxes.count()):
        before = page.evaluate(drawn)
        boxes.nth(number).locator("input").uncheck()
        page.wait_for_timeout(60)
        assert page.evaluate(drawn) != before, boxes.nth(number).inner_text()


def test_files_are_offered(report: str, open_page: OpenPage) -> None:
    page = open_page(report)
    names = page.locator(".downloads a").evaluate_all("links => links.map((one) => one.getAttribute('href'))")
    assert names == ["track.csv", "steps.csv", "summary.json", "track.tum"]
    folder = Path(report.removeprefix("file://")).parent
    assert all((folder / name).is_file() for name in names)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_fits_a_phone(report: str, open_page: OpenPage, scheme: str) -> None:
    page = open_page(report, width=390, height=844, color_scheme=scheme, has_touch=True, is_mobile=True)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    wide = "[...document.querySelectorAll('main *')].filter((one) => one.scrollWidth > one.clientWidth + 1"
    wide += " && getComputedStyle(one).overflowX === 'auto' && one.offsetParent).map((one) => one.className)"
    assert page.evaluate(wide) == []
    page.locator(".chart .u-over").first.tap(position={"x": 150, "y": 40})
    assert float(page.locator(".time-slider").input_value()) > 5.0


def test_tiles_come_from_the_chosen_server_and_nowhere_else(tmp_path: Path, open_page: OpenPage) -> None:
    recording = replace(simulate_walk(preset("office_loop")).recording, origin=GeoOrigin(48.2, 11.6))
    config = replace(Config(), start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0))
    walk = pipeline.smooth_recording(recording, config)
    tiles = read_background("https://tiles.example.org/{z}/{x}/{y}.png")
    write_results(tmp_path, walk, recording, config, {}, background=tiles)
    asked: list[str] = []

    def answer(route: Route) -> None:
        asked.append(route.request.url)
        route.fulfill(content_type="image/gif", body=base64.b64decode(ONE_PIXEL))

    page = open_page("about:blank")
    page.route(re.compile("^https?://"), answer)
    page.goto((tmp_path / "report.html").as_uri())
    expect(page.locator("#track-map img").nth(3)).to_be_attached()
    page.locator(".leaflet-control-zoom-in").click()
    page.wait_for_timeout(500)
    assert {url.split("/")[2] for url in asked} == {"tiles.example.org"}
    zoom, column, row = (int(part.removesuffix(".png")) for part in asked[0].split("/")[3:])
    assert abs((11.6 + 180.0) / 360.0 * 2**zoom - column) < 4.0
    assert abs(row / 2**zoom - 0.34678) < 0.001  # 48.2 degrees north
    assert "Map: tiles.example.org" in page.locator(".map-credit").inner_text()


def test_a_pose_at_several_places_shows_all_of_them(tmp_path: Path, open_page: OpenPage) -> None:
    recording = simulate_walk(preset("office_loop")).recording
    config = replace(Config(), start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0))
    walk = pipeline.smooth_recording(recording, config)
    region = PoseRegion.of_gaussians(walk.track.position_m, walk.track.covariance_m2)
    late = slice(len(region) - 40, None)
    region.weight[late, :2] = (0.7, 0.3)
    region.mean_m[late, 1] = region.mean_m[late, 0] + np.array([0.0, -9.0])
    region.covariance_m2[late, 1] = 2.0 * np.eye(2)
    walk = replace(walk, track=replace(walk.track, region=region))
    write_results(tmp_path, walk, recording, config, {})
    page = open_page((tmp_path / "report.html").as_uri())
    at_time = "(slider, time) => { slider.value = time; slider.dispatchEvent(new Event('input')); }"
    page.locator(".time-slider").evaluate(at_time, 10)
    assert "places" not in cell(page, 2)
    page.locator(".time-slider").evaluate(at_time, float(walk.track.time_s[-5]))
    assert cell(page, 2).replace("\u00a0", " ").endswith("; 2 places: 70 %, 30 %")
    boxes = page.locator("#map-toggles input")
    page.locator("#track-map").scroll_into_view_if_needed()
    page.wait_for_timeout(300)
    shown = page.locator("#track-map").screenshot()
    boxes.first.uncheck()  # the 95 % regions
    page.wait_for_timeout(300)
    assert page.locator("#track-map").screenshot() != shown
    box = page.locator("#track-map").bounding_box()
    assert box is not None
    _, lowest_m = pointed_place(page, box["x"] + 300.0, box["y"] + box["height"] - 2.0)
    assert lowest_m < region.mean_m[-1, 1, 1] - 2.0  # the other places are in sight


def test_numbers_are_written_for_reading(report: str, open_page: OpenPage) -> None:
    page = open_page(report)
    written = page.evaluate("[numberText(-0.4, 0), numberText(-1.25, 1), numberText(NaN, 1), timeText(125.0)]")
    assert written == ["0", "−1.3", "–", "2:05.0"]


def test_the_floor_is_chosen_and_follows_the_cursor(tmp_path: Path, open_page: OpenPage) -> None:
    recording, config = over_three_storeys().recording, TURNED.with_estimator("particle")
    write_results(tmp_path, pipeline.smooth_recording(recording, config, plan=BUILDING), recording, config, {})
    page = open_page((tmp_path / "report.html").as_uri())
    floors = page.locator("input[name=floor]")
    expect(floors).to_have_count(3)
    expect(floors.nth(0)).to_be_checked()
    expect(page.locator(".legend li", has_text="walkable floor").first).to_be_visible()
    plans = page.locator(".leaflet-plan-pane canvas")
    drawn = "canvases => canvases.map((canvas) => canvas.toDataURL()).join()"
    pictures = {plans.evaluate_all(drawn)}
    floors.nth(2).check()
    assert float(page.locator(".time-slider").input_value()) > 90.0  # the lift
    page.wait_for_timeout(300)
    pictures.add(plans.evaluate_all(drawn))
    page.locator(".time-slider").fill("10")
    expect(floors.nth(0)).to_be_checked()
    page.locator(".time-slider").fill("70")
    expect(floors.nth(1)).to_be_checked()
    page.wait_for_timeout(300)
    pictures.add(plans.evaluate_all(drawn))
    assert len(pictures) == 3


def test_the_page_of_a_plan_fits_a_phone(tmp_path: Path, open_page: OpenPage) -> None:
    corners = [[0, 0], [90, 0], [90, 20], [0, 20], [0, 0]]
    hall = f'{{"type": "Feature", "geometry": {{"type": "Polygon", "coordinates": [{corners}]}}}}'
    (tmp_path / "hall.geojson").write_text(hall)
    call = ["plan", str(tmp_path / "hall.geojson"), "-o", str(tmp_path / "out"), "-q"]
    assert main(call, standalone_mode=False) in (None, 0)
    page = open_page((tmp_path / "out" / "plan.html").as_uri(), width=390, java_script_enabled=False)
    box = page.locator(".plot > svg").bounding_box()
    assert box is not None
    assert box["x"] + box["width"] <= 390
