"""`pdr-est convert`: each format is read back to the same steps, and no input is ever replaced."""

import json
from pathlib import Path

import pytest
from cli_recordings import Walk, columns_of, lines_of, save
from cli_runs import refused, run


def steps_of(recording: Path) -> tuple[int, str]:
    result = run("steps", recording, "--json")
    assert result.exit_code == 0, result.output
    (document,) = json.loads(result.stdout)
    return document["steps"], max(document["modes"], key=document["modes"].get)


@pytest.mark.parametrize("name", ["walk.csv", "walk.parquet", "walk.npz", "export"])
def test_each_format_has_the_same_steps(name: str, good: Path, export_zip: Path, tmp_path: Path) -> None:
    for number, source in enumerate((good, export_zip)):
        (tmp_path / str(number)).mkdir()
        out = tmp_path / str(number) / name
        result = run("convert", source, "-o", out)
        assert result.exit_code == 0, result.output
        assert str(out) in result.stdout
        assert steps_of(out) == steps_of(source)


def test_the_format_may_be_named(good: Path, tmp_path: Path) -> None:
    assert run("convert", good, "-o", tmp_path / "x.dat", "--format", "parquet").exit_code == 0
    assert (tmp_path / "x.dat").read_bytes()[:4] == b"PAR1"
    assert "the extension tells no format: give --format csv|parquet" in refused(
        "convert", good, "-o", tmp_path / "y.dat"
    )


def test_a_part_of_one_device(good: Path, walk: Walk, tmp_path: Path) -> None:
    other = save(tmp_path / "other.csv", lines_of(columns_of(walk, force=walk.force * 1.001)))
    assert "write each into its own" in refused("convert", good, other, "-o", tmp_path / "both.csv")
    options = ("--device", "other", "--from", "5", "--to", "9")
    assert run("convert", good, other, "-o", tmp_path / "one.csv", *options).exit_code == 0
    document = json.loads(run("inspect", tmp_path / "one.csv", "--json").stdout)
    assert document["duration_s"] == pytest.approx(4.0, abs=0.05)


def test_what_has_no_place_is_told(export_zip: Path, tmp_path: Path) -> None:
    told = run("convert", export_zip, "-o", tmp_path / "walk.csv").stderr
    assert "has no place for the date of time zero" in told
    assert "position fixes" in told
    assert run("convert", export_zip, "-o", tmp_path / "folder").stderr == ""


def test_nothing_is_replaced_unasked(good: Path, tmp_path: Path) -> None:
    before = good.read_bytes()
    assert "is the input" in refused("convert", good, "-o", good, "--overwrite")
    assert good.read_bytes() == before
    out = tmp_path / "walk.parquet"
    assert run("convert", good, "-o", out).exit_code == 0
    assert "exists already" in refused("convert", good, "-o", out)
    assert run("convert", good, "-o", out, "--overwrite").exit_code == 0
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("x", encoding="utf-8")
    assert "files of other origin" in refused("convert", good, "-o", tmp_path / "mine", "--overwrite")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine", "walk.parquet"]
