"""The simulated walk that the tests of the command line damage in their ways."""

from pathlib import Path

import pytest
from cli_recordings import Walk, as_zip, columns_of, lines_of, make_walk, save, sensor_logger, with_attitude


@pytest.fixture
def without_report(monkeypatch: pytest.MonkeyPatch) -> None:
    """Results without the page: plotting takes nearly all the time of a run."""
    monkeypatch.setattr("pdr_est.report.walk.page.render_report", lambda *_: "<html></html>")


@pytest.fixture(scope="session")
def walk() -> Walk:
    return make_walk()


@pytest.fixture(scope="session")
def lines(walk: Walk) -> list[str]:
    """The table of a good recording with accelerometer and gyroscope, the header first."""
    return lines_of(columns_of(walk))


@pytest.fixture(scope="session")
def good(walk: Walk, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A good recording with the device's attitude."""
    return save(tmp_path_factory.mktemp("good") / "walk.csv", lines_of(with_attitude(walk)))


@pytest.fixture(scope="session")
def export(walk: Walk) -> dict[str, bytes]:
    """The members of a good Sensor Logger export."""
    return sensor_logger(walk)


@pytest.fixture(scope="session")
def export_zip(export: dict[str, bytes], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return as_zip(tmp_path_factory.mktemp("export") / "walk.zip", export)
