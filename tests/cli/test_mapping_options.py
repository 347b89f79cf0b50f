"""The options --map and --write-map."""

from pathlib import Path

import pytest
from click.testing import CliRunner
from table_layouts import plain, text
from table_walk import rows, table_walk

from pdr_est.cli import main


@pytest.fixture
def table(tmp_path: Path) -> Path:
    """A walk without time."""
    columns = plain(table_walk())
    del columns["time"]
    (tmp_path / "walk.csv").write_bytes(text(rows(columns)))
    return tmp_path / "walk.csv"


def test_a_table_without_time_is_read_with_a_mapping(table: Path) -> None:
    refused = CliRunner().invoke(main, ["steps", str(table)])
    assert refused.exit_code == 2
    assert "rate_hz" in refused.output
    draft = table.parent / "draft.yaml"
    assert CliRunner().invoke(main, ["inspect", str(table), "--write-map", str(draft)]).exit_code == 0
    (table.parent / "map.yaml").write_text("time: {rate_hz: 50}\n" + draft.read_text())
    for command in (["inspect"], ["steps"], ["smooth", "-q", "-o", str(table.parent / "out")]):
        result = CliRunner().invoke(main, [*command, str(table), "--map", str(table.parent / "map.yaml")])
        assert result.exit_code == 0, result.output


def test_mistakes_with_the_options(table: Path) -> None:
    twice = CliRunner().invoke(main, ["inspect", str(table), str(table), "--write-map", "map.yaml"])
    assert "describes one RECORDING" in twice.output
    absent = CliRunner().invoke(main, ["steps", str(table), "--map", str(table.parent / "absent.yaml")])
    assert absent.exit_code == 2
    assert "absent.yaml: cannot be read" in absent.output
