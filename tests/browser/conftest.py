"""Opens pages in a real Chromium; without one the tests are skipped and say why."""

import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

CHROMIUM = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), ""
)

QUIET = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


@dataclass
class OpenPage:
    """A page in the browser, and what it complained about."""

    page: Page
    complaints: list[str] = field(default_factory=list)


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    """Start one headless Chromium for the tests of a file; its event loop ends with it."""
    if not CHROMIUM:
        pytest.skip("no Chromium: install the package chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        yield browser
        browser.close()


@pytest.fixture
def open_page(chromium: Browser) -> Iterator[Callable[..., Page]]:
    """Give a function that opens an address in a window of the given size; errors on the console fail the test."""
    opened: list[OpenPage] = []
    contexts: list[BrowserContext] = []

    def opener(url: str, *, width: int = 1280, height: int = 900, **context: object) -> Page:
        contexts.append(chromium.new_context(viewport={"width": width, "height": height}, **context))
        one = OpenPage(contexts[-1].new_page())
        opened.append(one)
        one.page.on("pageerror", lambda error: one.complaints.append(str(error)))
        one.page.on("console", lambda said: one.complaints.append(said.text) if said.type == "error" else None)
        one.page.goto(url)
        return one.page

    yield opener
    for context in contexts:
        context.close()
    assert [one.complaints for one in opened] == [[] for _ in opened]
