"""The page of `pdr-est evaluate` in a real browser: map and errors under one cursor, phone width, print."""

import re
from collections.abc import Callable

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from pdr_est.cli import main

OPEN = Callable[..., Page]

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Page of two devices on a walk around a square, one of them 0.5 m and one 2 m beside the truth."""
    folder = tmp_path_factory.mktemp("evaluation")
    time_s = np.arange(0.0, 81.0)
    corners = np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0], [0.0, 0.0]])
    place_m = np.column_stack([np.interp(time_s, np.arange(0.0, 81.0, 20.0), corners[:, axis]) for axis in (0, 1)])
    track = ["device,time_s,x_m,y_m"]
    for device, beside_m in (("1 <left>", 0.5), ("2 right", 2.0)):
        track += [f"{device},{t},{x},{y + beside_m}" for t, (x, y) in zip(time_s, place_m, strict=True)]
    truth = ["time_s,x_m,y_m", *(f"{t},{x},{y}" for t, (x, y) in list(zip(time_s, place_m, strict=True))[::8])]
    (folder / "track.csv").write_text("\n".join(track) + "\n", encoding="utf-8")
    (folder / "truth.csv").write_text("\n".join(truth) + "\n", encoding="utf-8")
    arguments = ["evaluate", str(folder / "track.csv"), "--truth", str(folder / "truth.csv"), "--align", "none"]
    assert main([*arguments, "-o", str(folder / "scored")], standalone_mode=False) in (None, 0)
    return (folder / "scored" / "report.html").as_uri()


def inked(page: Page) -> int:
    """Number of pixels that are drawn on the map."""
    count = """() => [...document.querySelectorAll('#track-map canvas')].map((canvas) => canvas.getContext('2d')
        .getImageData(0, 0, canvas.width, canvas.height).data.filter((v, i) => i % 4 === 3 && v > 0).length)
        .reduce((a, b) => a + b, 0)"""
    page.wait_for_timeout(150)
    return int(page.evaluate(count))


def test_one_cursor_moves_on_the_map_and_in_the_errors(open_page: OPEN, address: str) -> None:
    page = open_page(address)
    expect(page.locator(".readout")).to_have_text("1 <left> 0.50 · 2 right 2.00")
    chart = page.locator("#charts .u-over")
    box = chart.bounding_box()
    assert box is not None
    chart.hover(position={"x": box["width"] / 2, "y": box["height"] / 2})
    expect(page.locator(".time-now")).to_have_text(re.compile(r"^(39|40)\.\d s$"))
    before = page.locator(".time-now").inner_text()
    page.click(".play")
    expect(page.locator(".time-now")).not_to_have_text(before)


def test_devices_and_truth_can_be_hidden(open_page: OPEN, address: str) -> None:
    page = open_page(address)
    labels = page.locator("#map-toggles label")
    assert [text.strip() for text in labels.all_inner_texts()] == ["1 <left>", "2 right", "truth"]
    shown = [inked(page)]
    for box in page.locator("#map-toggles input").all():
        box.uncheck()
        shown.append(inked(page))
    assert shown == sorted(shown, reverse=True)
    assert len(set(shown)) == 4
    assert shown[-1] == 0


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_phone_shows_it_without_sideways_scrolling(open_page: OPEN, address: str, scheme: str) -> None:
    page = open_page(address, width=390, height=844, color_scheme=scheme, is_mobile=True, has_touch=True)
    assert page.evaluate("document.scrollingElement.scrollWidth") == 390
    for part in page.locator("td, #track-map, #charts canvas").all():
        box = part.bounding_box()
        assert box is None or box["x"] + box["width"] <= 390


def test_without_scripts_and_in_print_the_pictures_are_there(open_page: OPEN, address: str) -> None:
    bare = open_page(address, java_script_enabled=False)
    expect(bare.locator(".plot").first).to_be_visible()
    expect(bare.locator("#track-map")).to_be_hidden()
    page = open_page(address)
    expect(page.locator(".plot").first).to_be_hidden()
    page.emulate_media(media="print")
    expect(page.locator(".plot").first).to_be_visible()
    expect(page.locator("#track-map")).to_be_hidden()


def test_the_page_loads_nothing(open_page: OPEN, address: str) -> None:
    page = open_page(address)
    loaded = page.evaluate("performance.getEntriesByType('resource').map((one) => one.name)")
    assert [name for name in loaded if not name.startswith(("data:", "blob:"))] == []
