"""The report of a walk in a real browser."""

from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page

from pdr_est.cli import main


def test_opens_without_an_error(tmp_path: Path, open_page: Callable[..., Page]) -> None:
    assert main(["demo", "-o", str(tmp_path / "demo")], standalone_mode=False) in (None, 0)
    page = open_page((tmp_path / "demo" / "report.html").as_uri())
    assert "pedestrian track" in page.title()
