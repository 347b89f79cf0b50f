"""The page of an experiment in a real browser: filters, sorting, tracks, definitions, phone width, print."""

import re
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Locator, Page, expect

from pdr_est.evaluate.statistics import Average
from pdr_est.report.comparison.page import ComparisonContent, render_comparison
from pdr_est.report.comparison.tables import format_metric
from pdr_est.types.outcome import TrackOutcome

VARIANTS = ("near", "far", "<img src=x onerror=document.title='x'>")
METRICS = ("error_heldout_m", "length_ratio")
OPEN = Callable[..., Page]

pytestmark = pytest.mark.slow


def outcome(number: int, variant: str, rng: np.random.Generator, points: int = 60) -> TrackOutcome:
    turn = np.cumsum(np.where(rng.random(points) < 0.05, 1.57, 0.0))
    truth_m = 0.7 * np.cumsum(np.column_stack([np.cos(turn), np.sin(turn)]), axis=0)
    error_m = np.abs(rng.normal(1.0, 0.4, 12)) * (1.0 if variant == "near" else 3.0)
    return TrackOutcome(
        walk=f"walk-{number:03d}",
        track="phone",
        variant=variant,
        labels={"carrying": ("HOLDING", "POCKET", "</script><b>")[number % 3]},
        mode="HOLDING",
        metrics={"error_heldout_m": float(error_m.mean()), "length_ratio": float(rng.normal(1.0, 0.1))},
        steps=points,
        true_steps=points,
        mode_shares={"HOLDING": 1.0},
        with_fixes=True,
        position_m=truth_m + np.array([0.0, float(error_m.mean())]),
        truth_m=truth_m[::6],
        way_m=np.linspace(0.0, 0.7 * points, 12),
        error_m=error_m,
        squared=rng.chisquare(2, 12),
    )


def content_of(walks: int, variants: tuple[str, ...]) -> ComparisonContent:
    rng = np.random.default_rng(3)
    outcomes = tuple(outcome(number, name, rng) for number in range(walks) for name in variants)
    provenance = {"version": "1", "commit": None, "seed": 0, "fingerprint": {}, "packages": {}}
    return ComparisonContent(
        "Three & <more>", variants, METRICS, ("carrying",), outcomes, (), 0, (), "data: {}\n", provenance
    )


@pytest.fixture(scope="module")
def content() -> ComparisonContent:
    return content_of(40, VARIANTS)


@pytest.fixture(scope="module")
def address(content: ComparisonContent, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("comparison") / "report.html"
    path.write_text(render_comparison(content), encoding="utf-8")
    return path.as_uri()


def texts(rows: Locator, column: int) -> list[str]:
    """Texts of a column."""
    cells = rows.locator(f":scope > :nth-child({column + 1})")
    return [text.strip() for text in cells.all_inner_texts()]


def values_of(content: ComparisonContent, variant: str, metric: str = METRICS[0]) -> list[float]:
    return [one.metrics[metric] or 0.0 for one in content.outcomes if one.variant == variant]


def inked(page: Page) -> int:
    """Number of pixels that are drawn on the map."""
    count = """() => [...document.querySelectorAll('#walk-map canvas')].map((canvas) => canvas.getContext('2d')
        .getImageData(0, 0, canvas.width, canvas.height).data.filter((v, i) => i % 4 === 3 && v > 0).length)
        .reduce((a, b) => a + b, 0)"""
    page.wait_for_timeout(100)
    return int(page.evaluate(count))


def test_walks_are_sorted_by_a_press_on_a_heading(open_page: OPEN, address: str, content: ComparisonContent) -> None:
    page = open_page(address)
    rows = page.locator("#walks-table tbody tr")
    page.select_option("#walks-rows", "50")
    expect(rows).to_have_count(40)
    ordered = [format_metric(value) for value in sorted(values_of(content, "near"), reverse=True)]
    page.click("#walks-table .sort:text-is('near')")
    assert texts(rows, 2) == ordered
    expect(page.locator("#walks-table th[aria-sort=descending]")).to_have_text("near")
    page.click("#walks-table .sort:text-is('near')")
    assert texts(rows, 2) == ordered[::-1]
    page.click("#walks-table .sort:text-is('walk')")
    assert texts(rows, 0) == [f"walk-{number:03d}" for number in range(40)]


def test_the_worst_walks_come_first_and_the_first_of_them_is_drawn(open_page: OPEN, address: str) -> None:
    page = open_page(address)
    off = [float(text) for text in texts(page.locator("#walks-table tbody tr"), 1)]
    assert off == sorted(off, reverse=True)
    first = texts(page.locator("#walks-table tbody tr"), 0)[0]
    expect(page.locator("#walk-name")).to_have_text(first)
    assert inked(page) > 500


def test_filters_choose_walks_and_the_averages_follow(
    open_page: OPEN, address: str, content: ComparisonContent
) -> None:
    page = open_page(address)
    averages = page.locator("#walks-table thead tr.average")
    whole = Average.of(values_of(content, "far"))
    assert texts(averages, 3) == [format_metric(value) for value in (whole.mean, whole.median, whole.p90)]
    page.select_option("select[data-key=carrying]", label="POCKET")
    expect(page.locator("#walks-count")).to_have_text("13 of 40 tracks")
    some = Average.of(values_of(content, "far")[1::3])
    assert texts(averages, 3) == [format_metric(value) for value in (some.mean, some.median, some.p90)]
    page.fill("#walks-search", "WALK-01")
    expect(page.locator("#walks-count")).to_have_text("4 of 40 tracks")
    page.click("#walks-reset")
    expect(page.locator("#walks-count")).to_have_text("All 40 tracks")
    page.fill("#walks-search", "nothing has this name")
    expect(page.locator("#walks-count")).to_have_text("0 of 40 tracks")
    assert texts(averages, 3) == ["–"] * 3


def test_a_press_on_a_walk_shows_its_tracks(open_page: OPEN, address: str, content: ComparisonContent) -> None:
    page = open_page(address)
    page.fill("#walks-search", "walk-007")
    page.click("#walks-table .walk")
    expect(page.locator("#walk-name")).to_have_text("walk-007")
    shown = page.locator("#walk-lines .value").all_inner_texts()
    assert shown == [f"{format_metric(values_of(content, name)[7])} m" for name in VARIANTS]
    whole = inked(page)
    for box in page.locator("#walk-lines input").all():
        box.uncheck()
    assert inked(page) == 0
    page.locator("#walk-lines input").first.check()
    assert 0 < inked(page) < whole
    page.click("#walks-reset")
    order = page.locator("#walks-table .walk")
    order.nth(2).click()
    page.click("#walk-after")
    expect(page.locator("#walk-name")).to_have_text(order.nth(3).inner_text())
    expect(page.locator("#walks-table tr[aria-current=true] .walk")).to_have_text(order.nth(3).inner_text())


def test_the_pages_of_the_table_hold_every_walk_once(open_page: OPEN, address: str) -> None:
    page = open_page(address)
    seen = texts(page.locator("#walks-table tbody tr"), 0)
    while page.locator("#walks-pages button").last.is_enabled():
        page.locator("#walks-pages button").last.click()
        seen += texts(page.locator("#walks-table tbody tr"), 0)
    assert sorted(seen) == [f"walk-{number:03d}" for number in range(40)]


def test_another_metric_is_shown_with_its_definition(open_page: OPEN, address: str) -> None:
    page = open_page(address)
    page.select_option("#walks-metric", "length_ratio")
    expect(page.locator("#walks-meaning")).to_contain_text("over the length of the true way. Ideal:\u00a01.")
    expect(page.locator("#walk-lines .value").first).to_have_text(re.compile(r"^[01]\.\d{3}$"))


def test_metrics_are_explained_where_they_stand(open_page: OPEN, address: str) -> None:
    page = open_page(address)
    note = page.locator("#definition-note")
    expect(note).to_be_hidden()
    page.click("table.sortable a[href='#define-length_ratio'] >> nth=0")
    expect(note).to_contain_text("Length of the track between the first and the last true position")
    page.keyboard.press("Escape")
    expect(note).to_be_hidden()
    page.hover("table.sortable a[href='#define-error_heldout_m'] >> nth=0")
    expect(note).to_contain_text("held-out true positions")
    assert "#" not in page.url


def test_tables_are_sorted_within_a_metric(open_page: OPEN, address: str) -> None:
    page = open_page(address)
    table = page.locator("table.sortable").first
    table.locator(".sort:text-is('mean')").click()
    means = [float(text) for text in texts(table.locator("tbody tr"), 2)]
    assert means[:3] == sorted(means[:3])
    assert means[3:] == sorted(means[3:])
    assert table.locator("tbody tr.first").count() == len(METRICS)
    table.locator(".sort:text-is('metric')").click()
    table.locator(".sort:text-is('metric')").click()
    expect(table.locator("tbody tr.first a").first).to_have_text("length_ratio")


def test_curves_tell_their_values_and_can_be_hidden(open_page: OPEN, address: str) -> None:
    page = open_page(address)
    chart = page.locator("[data-curve=cdf]")
    chart.locator(".u-over").hover()
    expect(chart.locator(".readout")).to_have_text(re.compile(r"^error \(m\): \d"))
    assert all(text.endswith(" %") for text in chart.locator(".value").all_inner_texts())
    drawn = "(chart) => chart.querySelector('canvas').toDataURL()"
    before = chart.evaluate(drawn)
    chart.locator("input").first.uncheck()
    page.wait_for_timeout(100)
    assert chart.evaluate(drawn) != before


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_phone_shows_it_without_sideways_scrolling(open_page: OPEN, address: str, scheme: str) -> None:
    page = open_page(address, width=390, height=844, color_scheme=scheme, has_touch=True, is_mobile=True)
    assert page.evaluate("document.scrollingElement.scrollWidth") == 390
    page.locator("details summary").first.click()
    page.tap("table.sortable a >> nth=0")
    box = page.locator("#definition-note").bounding_box()
    assert box is not None
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= 390
    assert page.evaluate("document.scrollingElement.scrollWidth") == 390
    for chart in page.locator("[data-curve] canvas").all():
        drawn = chart.bounding_box()
        assert drawn is not None
        assert drawn["x"] + drawn["width"] <= 390


def test_without_scripts_and_in_print_the_pictures_are_there(open_page: OPEN, address: str) -> None:
    bare = open_page(address, java_script_enabled=False)
    expect(bare.locator("text=Worst walk by error_heldout_m")).to_be_visible()
    expect(bare.locator(".plot").first).to_be_visible()
    expect(bare.locator("#walks")).to_be_hidden()
    page = open_page(address)
    expect(page.locator("text=Worst walk by error_heldout_m")).to_be_hidden()
    page.emulate_media(media="print")
    expect(page.locator("text=Worst walk by error_heldout_m")).to_be_visible()
    expect(page.locator("#walks")).to_be_hidden()


def test_names_are_text_and_nothing_foreign_runs_or_loads(open_page: OPEN, address: str) -> None:
    page = open_page(address)
    page.click("summary:text-is('All metrics of this walk')")
    assert page.title() == "Three & <more> · comparison"
    assert page.locator("img").count() == 0
    assert page.locator("#walks-table b").count() == 0
    expect(page.locator("#walk-values thead th").last).to_have_text(VARIANTS[2])
    loaded = page.evaluate("performance.getEntriesByType('resource').map((one) => one.name)")
    assert [name for name in loaded if not name.startswith(("data:", "blob:"))] == []


def test_a_script_that_was_smuggled_in_does_not_run(chromium: object, tmp_path: Path, address: str) -> None:
    path = tmp_path / "smuggled.html"
    text = Path(address.removeprefix("file://")).read_text(encoding="utf-8")
    path.write_text(text.replace("</main>", "<script>document.title = 'run'</script></main>"), encoding="utf-8")
    page = chromium.new_page()  # type: ignore[attr-defined]  # which may complain on its console, as it must
    page.goto(path.as_uri())
    assert page.title() == "Three & <more> · comparison"
    page.close()


def test_a_single_walk_with_few_values_has_a_page(
    open_page: OPEN, content: ComparisonContent, tmp_path: Path
) -> None:
    lone = replace(content.outcomes[0], position_m=np.empty((0, 2)), truth_m=np.empty((0, 2)))
    lone = replace(lone, metrics={"error_heldout_m": 0.4, "length_ratio": None}, error_m=np.array([0.4]))
    lone = replace(lone, way_m=np.array([3.0]), squared=np.empty(0))
    (tmp_path / "one.html").write_text(render_comparison(replace(content, outcomes=(lone,))), encoding="utf-8")
    page = open_page((tmp_path / "one.html").as_uri())
    expect(page.locator("#walks-count")).to_have_text("All 1 tracks")
    assert texts(page.locator("#walks-table tbody tr"), 3) == ["–"]


def test_variants_that_are_only_aligned_with_the_fixes_are_marked_where_that_matters(
    open_page: OPEN, content: ComparisonContent, tmp_path: Path
) -> None:
    (tmp_path / "marked.html").write_text(render_comparison(replace(content, aligned=("far",))), encoding="utf-8")
    page = open_page((tmp_path / "marked.html").as_uri())
    expect(page.locator("#walks-table .sort", has_text="far")).to_have_text("far *")
    expect(page.locator("#walks-aligned")).to_contain_text("takes no measurement from the position fixes")
    expect(page.locator("#walk-lines .value").nth(1)).to_have_text(re.compile(r" m \*$"))
    page.select_option("#walks-metric", "length_ratio")
    expect(page.locator("#walks-table .sort", has_text="far")).to_have_text("far")
    expect(page.locator("#walks-aligned")).to_be_hidden()


def timed(page: Page, selector: str, times: int) -> Iterator[float]:
    """Time from a press until the next picture is drawn, ms."""
    measure = """(selector) => new Promise((done) => {
        const begin = performance.now();
        document.querySelector(selector).click();
        requestAnimationFrame(() => setTimeout(() => done(performance.now() - begin), 0));
    })"""
    for _ in range(times):
        yield float(page.evaluate(measure, selector))


@pytest.mark.slow
def test_a_thousand_walks_by_twelve_variants_are_sorted_at_once(open_page: OPEN, tmp_path: Path) -> None:
    path = tmp_path / "large.html"
    path.write_text(render_comparison(content_of(1000, tuple(f"variant {i}" for i in range(12)))), encoding="utf-8")
    assert path.stat().st_size < 3_000_000
    begin_s = time.perf_counter()
    page = open_page(path.as_uri())
    expect(page.locator("#walks-count")).to_have_text("All 1000 tracks")
    assert time.perf_counter() - begin_s < 10.0  # about 1 s on an idle computer
    assert np.median(list(timed(page, "#walks-table th:nth-child(5) .sort", 7))) < 500.0  # about 20 ms
    assert np.median(list(timed(page, "#walks-table tbody tr:nth-child(4) .walk", 7))) < 500.0
