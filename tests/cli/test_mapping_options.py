"""The options --map and --write-map."""

from pathlib import Path

import pytest
from click.testing import CliRunner
from table_layouts import plain, text
from table_walk import rows, table_walk

from pdr_est.cli import main
from pdr_est.cli.walk_list import are_separate_walks
from pdr_est.io.tables.mapping_file import load_mapping


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


def test_a_mapping_holds_for_each_of_several_walks(table: Path, tmp_path: Path) -> None:
    """Neither the list of the walks in a folder nor their dates can be found without it."""
    draft, mapping = tmp_path / "draft.yaml", tmp_path / "map.yaml"
    assert CliRunner().invoke(main, ["inspect", str(table), "--write-map", str(draft)]).exit_code == 0
    words = draft.read_text()
    header, *below = table.read_text().splitlines()
    for number, title in enumerate(header.split(",")):
        words = words.replace(f"{title}", f"channel{number}")
    mapping.write_text("time: {rate_hz: 50}\n" + words)
    folder = tmp_path / "walks"
    folder.mkdir()
    titles = ",".join(f"channel{number}" for number in range(len(header.split(","))))
    for name in "abc":
        (folder / f"{name}.csv").write_text("\n".join([titles, *below]) + "\n")
    result = CliRunner().invoke(main, ["steps", str(folder), "--map", str(mapping)])
    assert result.exit_code == 0, result.output
    assert result.stdout.count(" steps in ") == 3
    assert not are_separate_walks(sorted(folder.iterdir()), load_mapping(mapping))


def test_mistakes_with_the_options(table: Path) -> None:
    twice = CliRunner().invoke(main, ["inspect", str(table), str(table), "--write-map", "map.yaml"])
    assert "describes one RECORDING" in twice.output
    absent = CliRunner().invoke(main, ["steps", str(table), "--map", str(table.parent / "absent.yaml")])
    assert absent.exit_code == 2
    assert "absent.yaml: cannot be read" in absent.output
