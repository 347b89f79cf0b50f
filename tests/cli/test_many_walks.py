"""Many walks in one call: `smooth --each`, folders, patterns, `--jobs`, and the table of all walks."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest
from cli_recordings import Walk, as_folder, as_zip, ilc20_log, save, sensor_logger
from cli_runs import refused, run

from pdr_est.cli.walk_list import named_paths

pytestmark = pytest.mark.usefixtures("without_report")

FILES = {"track.csv", "steps.csv", "track.tum", "track.geojson", "summary.json"}


@pytest.fixture(scope="module")
def folder(walk: Walk, lines: list[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two walks in one folder and one below it."""
    place = tmp_path_factory.mktemp("walks")
    (place / "more").mkdir()
    save(place / "a.csv", lines)
    save(place / "b.csv", lines[:-100])
    save(place / "more" / "c.csv", lines[:-50])
    return place


def rows_of(table: Path) -> list[dict[str, str]]:
    with table.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def names_in(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir() if not path.name.startswith(".")}


def test_a_folder_of_walks_becomes_a_folder_of_results(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    result = run("smooth", folder, "-o", out)
    assert result.exit_code == 0, result.output
    assert names_in(out) == {"a", "b", "c", "walks.csv"}
    assert names_in(out / "a") == names_in(out / "c") == FILES
    rows = rows_of(out / "walks.csv")
    assert [row["walk"] for row in rows] == ["a", "b", "c"]
    assert all(int(row["steps"]) > 10 and float(row["distance_m"]) > 5.0 and row["failed"] == "" for row in rows)
    assert "3 of 3 walks" in result.stdout
    assert "walk  steps" in result.stdout
    alone = tmp_path / "alone"
    assert run("smooth", folder / "b.csv", "-o", alone).exit_code == 0
    assert (out / "b" / "track.csv").read_bytes() == (alone / "track.csv").read_bytes()


def test_a_walk_that_fails_leaves_the_others(folder: Path, lines: list[str], tmp_path: Path) -> None:
    torn = save(tmp_path / "torn.csv", lines[:3])
    out = tmp_path / "out"
    result = run("smooth", folder / "a.csv", torn, folder / "b.csv", "-o", out, "--each")
    assert result.exit_code == 2
    assert (out / "a" / "track.csv").exists()
    assert (out / "b" / "track.csv").exists()
    assert not (out / "torn").exists()
    told, error = result.stderr.splitlines()
    assert told.startswith(f"failed: {torn}: ")
    assert error.startswith("Error: 1 of 3 walks failed (")
    failed = [row["failed"] for row in rows_of(out / "walks.csv")]
    assert [bool(reason) for reason in failed] == [False, True, False]


@pytest.mark.slow
def test_several_processes_give_the_same(folder: Path, tmp_path: Path) -> None:
    pattern = folder / "[ab].csv"
    assert run("smooth", pattern, "-o", tmp_path / "one", "--each").exit_code == 0
    assert run("smooth", pattern, "-o", tmp_path / "two", "--jobs", "2").exit_code == 0
    for name in ("a", "b"):
        tracks = [(tmp_path / out / name / "track.csv").read_bytes() for out in ("one", "two")]
        assert tracks[0] == tracks[1]
    assert [row["steps"] for row in rows_of(tmp_path / "one" / "walks.csv")] == [
        row["steps"] for row in rows_of(tmp_path / "two" / "walks.csv")
    ]


def test_pages_are_written_if_asked_for(folder: Path, tmp_path: Path) -> None:
    assert run("smooth", folder / "a.csv", "-o", tmp_path / "many", "--each", "--report").exit_code == 0
    assert names_in(tmp_path / "many" / "a") == {*FILES, "report.html"}
    assert run("smooth", folder / "a.csv", "-o", tmp_path / "one", "--no-report").exit_code == 0
    assert names_in(tmp_path / "one") == FILES


def test_results_of_an_earlier_run_are_replaced_if_allowed(folder: Path, tmp_path: Path) -> None:
    command = ("smooth", folder, "-o", tmp_path / "out", "-q")
    assert run(*command).exit_code == 0
    assert "contains the results of an earlier run" in refused(*command)
    again = run(*command, "--overwrite")
    assert (again.exit_code, again.stdout) == (0, "")


def test_recordings_made_at_different_times_are_walks(walk: Walk, tmp_path: Path) -> None:
    """Three logs with dates, an hour apart: nobody has to say that they are no phones of one walk."""
    log = ilc20_log(walk, 4)
    paths = [tmp_path / f"{name}.txt" for name in "abc"]
    for hour, path in enumerate(paths):
        path.write_text(log.replace("17180307", str(17180307 + 36 * hour)), encoding="utf-8")
    result = run("smooth", *paths, "-o", tmp_path / "out")
    assert result.exit_code == 0, result.output
    rows = rows_of(tmp_path / "out" / "walks.csv")
    assert [row["walk"] for row in rows] == ["a", "b", "c"]
    assert all(float(row["ate_rigid_m"]) < 3.0 for row in rows)


def test_several_walks_have_no_common_length_or_table(folder: Path, tmp_path: Path) -> None:
    fixes = save(tmp_path / "fixes.csv", ["time_s,x_m,y_m", "1,0,0"])
    out = tmp_path / "out"
    assert "belong to one walk" in refused("smooth", folder, "-o", out, "--fixes", fixes)
    options = ("--learn", "--profile", tmp_path / "me.yaml", "--distance", 12)
    assert "the length of one walk" in refused("smooth", folder, "-o", out, *options)
    assert "lies inside the input" in refused("smooth", folder, "-o", folder / "out").replace("\\", "/")
    assert "no file has a name like that" in refused("smooth", folder / "*.txt", "-o", out)
    assert not out.exists()


def test_each_walk_is_learnt(walk: Walk, tmp_path: Path) -> None:
    end = len(walk.time_s) - 40
    shorter = replace(walk, time_s=walk.time_s[:end], force=walk.force[:end], rate=walk.rate[:end])
    for name, one in (("a", walk), ("b", shorter)):
        (tmp_path / f"{name}.txt").write_text(ilc20_log(one, 4), encoding="utf-8")
    options = ("--learn", "--profile", tmp_path / "me.yaml", "--fixes", "waypoints", "--each")
    result = run("smooth", tmp_path / "a.txt", tmp_path / "b.txt", "-o", tmp_path / "out", *options)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "me.yaml").read_text(encoding="utf-8").count("sha256:") == 2


@pytest.mark.slow
def test_steps_and_inspect_of_a_folder(folder: Path, tmp_path: Path) -> None:
    for command in ("steps", "inspect"):
        table = tmp_path / f"{command}.csv"
        result = run(command, folder, "--summary", table, "--jobs", "2")
        assert result.exit_code == 0, result.output
        assert [row["walk"] for row in rows_of(table)] == ["a", "b", "c"]
        assert all(int(row["steps"]) > 10 for row in rows_of(table))
        documents = json.loads(run(command, folder, "--json").stdout)
        assert len(documents) == 3
    assert "is the input" in refused_after(folder / "a.csv", "steps", folder / "a.csv", "--summary", folder / "a.csv")


def refused_after(untouched: Path, *arguments: object) -> str:
    before = untouched.read_bytes()
    result = run(*arguments)
    assert result.exit_code == 2
    assert untouched.read_bytes() == before
    return result.stderr


def test_folders_of_recordings_by_one_app(walk: Walk, tmp_path: Path) -> None:
    """A recording may itself be a folder."""
    for name in ("monday", "tuesday"):
        as_folder(tmp_path / "exports" / name, sensor_logger(walk))
    documents = json.loads(run("steps", tmp_path / "exports", "--json").stdout)
    assert [Path(document["recording"]).name for document in documents] == ["monday", "tuesday"]


def test_cells_are_no_formulas(lines: list[str], tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    save(tmp_path / "in" / "=1+1.csv", lines)
    save(tmp_path / "in" / "b.csv", lines)
    run("steps", tmp_path / "in", "--summary", tmp_path / "t.csv")
    assert rows_of(tmp_path / "t.csv")[0]["walk"] == "'=1+1"


def test_a_walk_that_is_named_twice_is_one_walk(folder: Path, tmp_path: Path) -> None:
    """Such as one that a folder and a pattern match."""
    table = tmp_path / "steps.csv"
    result = run("steps", folder / "a.csv", folder, folder / "*.csv", "--summary", table)
    assert result.exit_code == 0, result.output
    assert [row["walk"] for row in rows_of(table)] == ["a", "b", "c"]


def test_a_folder_of_archives_is_a_folder_of_walks(walk: Walk, tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    for name in ("monday", "tuesday"):
        as_zip(tmp_path / "in" / f"{name}.zip", sensor_logger(walk))
    documents = json.loads(run("steps", tmp_path / "in", "--json").stdout)
    assert [Path(document["recording"]).name for document in documents] == ["monday.zip", "tuesday.zip"]


def test_names_are_as_long_as_they_must_be() -> None:
    paths = [Path(path) for path in ("x/one/acc.csv.gz", "x/two/acc.csv", "y/b.zip", "y/c", "y/d.npz", "y/e.xlsx")]
    assert [walk.name for walk in named_paths(paths)] == ["one/acc", "two/acc", "b", "c", "d", "e"]
    assert [walk.name for walk in named_paths([Path("a.csv"), Path("a.txt")])] == ["a.csv", "a.txt"]
    assert [walk.name for walk in named_paths([Path("p/q"), Path("q/a.csv"), Path("r/a.csv")])] == ["q", "q_a", "r_a"]


def test_a_table_of_walks_replaces_nothing_else(folder: Path, tmp_path: Path) -> None:
    mine = save(tmp_path / "mine.csv", ["a,b", "1,2"])
    for command in ("steps", "inspect"):
        assert "is no table of walks" in refused(command, folder, "--summary", mine)
    (tmp_path / "out").mkdir()
    save(tmp_path / "out" / "walks.csv", ["a,b", "1,2"])
    assert "is no table of walks" in refused("smooth", folder, "-o", tmp_path / "out", "--overwrite")
    assert run("steps", folder, "--summary", tmp_path / "t.csv").exit_code == 0
    assert run("steps", folder, "--summary", tmp_path / "t.csv").exit_code == 0


def test_files_that_cannot_be_read_count_as_walks(folder: Path, lines: list[str], tmp_path: Path) -> None:
    walks = tmp_path / "walks"
    (walks / "day").mkdir(parents=True)
    save(walks / "a.csv", lines)
    save(walks / "day" / "b.csv", lines[:-50])
    save(walks / "day" / "page.csv", ["<html><p>not found</p></html>"])
    save(walks / "day" / "places.csv", ["time,lat,lon", *(f"{t},50.{t},8" for t in range(20))])
    save(walks / "README.txt", ["walks of a day"])
    save(walks / "a.json", ["{}"])
    out = tmp_path / "out"
    result = run("smooth", walks, "-o", out)
    assert result.exit_code == 2
    assert "2 of 4 walks -> " in result.stdout
    assert [row["walk"] for row in rows_of(out / "walks.csv")] == ["a", "b", "page", "places"]
    assert [line.split(": ")[1] for line in result.stderr.splitlines() if line.startswith("failed: ")] == [
        str(walks / "day" / name) for name in ("page.csv", "places.csv")
    ]
    assert "2 of 4 walks failed (page, places)" in result.stderr
    for command in ("steps", "inspect"):
        assert run(command, walks, "--summary", tmp_path / "table.csv").exit_code == 2
        assert len(rows_of(tmp_path / "table.csv")) == 4


def test_a_folder_may_hold_walks_of_several_apps(walk: Walk, lines: list[str], tmp_path: Path) -> None:
    walks = tmp_path / "walks"
    (walks / "app").mkdir(parents=True)
    save(walks / "a.csv", lines)
    save(walks / "b.csv", lines)
    as_folder(walks / "app", sensor_logger(walk))
    as_zip(walks / "c.zip", sensor_logger(walk))
    result = run("steps", walks, "--summary", tmp_path / "table.csv")
    assert result.exit_code == 0, result.output
    assert sorted(row["walk"] for row in rows_of(tmp_path / "table.csv")) == ["a", "app", "b", "c"]


def test_rows_of_several_persons_in_a_folder_are_asked_for(lines: list[str], tmp_path: Path) -> None:
    titles, *below = lines
    people = [f"{titles},user", *(f"{line},{name}" for name in ("ann", "bob") for line in below)]
    save(tmp_path / "walk.csv", people)
    assert "choose one with --device NAME" in refused("steps", tmp_path)
    assert run("steps", tmp_path, "--device", "bob").exit_code == 0
