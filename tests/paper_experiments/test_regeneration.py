"""experiments/all.py runs what has changed, in the order of what is read, and a failure stops nothing else."""

from pathlib import Path

import pytest
from test_mmpdr_tables import EXPERIMENTS, experiment

regeneration = experiment("regeneration")
Task, Place = regeneration.Task, regeneration.Place

WRITES = """
import sys
from pathlib import Path
from pack.used import NUMBER
out = Path(__file__).parent / "results"
Path(out / sys.argv[1]).write_text(str(NUMBER))
with (out / "order").open("a") as stream:
    stream.write(sys.argv[1] + " ")
"""


@pytest.fixture
def place(tmp_path: Path) -> Place:
    (tmp_path / "experiments" / "results").mkdir(parents=True)
    package = tmp_path / "pack"
    (package / "cli").mkdir(parents=True)
    for path in (package, package / "cli"):
        (path / "__init__.py").write_text("")
    (package / "used.py").write_text("from pack.deeper import NUMBER\n")
    (package / "deeper.py").write_text("NUMBER = 1\n")
    (package / "other.py").write_text("NUMBER = 5\n")
    (tmp_path / "experiments" / "writes.py").write_text(WRITES)
    (tmp_path / "experiments" / "fails.py").write_text("raise SystemExit(3)\n")
    return Place(
        experiments=tmp_path / "experiments",
        package=package,
        record=tmp_path / "experiments" / "results" / "fingerprints.json",
        logs=tmp_path / "logs",
    )


def writes(name: str, **more: object) -> Task:
    return Task(name, (("writes.py", f"{name}.txt"),), (f"results/{name}.txt",), **more)


def run(tasks: list[Task], place: Place, **more: object) -> regeneration.Outcome:
    return regeneration.regenerate(tasks, place, tell=lambda _: None, **more)


def order(place: Place) -> list[str]:
    return (place.experiments / "results" / "order").read_text().split()


def changed(path: Path, text: str) -> None:
    """Change a file, and forget what was read of it, as another run of the script would."""
    path.write_text(text)
    regeneration.code_digest.cache_clear()


def test_what_has_not_changed_is_not_run_again(place: Place) -> None:
    tasks = [writes("a"), writes("b")]
    assert list(run(tasks, place).done) == ["a", "b"]
    assert run(tasks, place).unchanged == ["a", "b"]
    (place.experiments / "results" / "b.txt").write_text("by hand")
    again = run(tasks, place)
    assert (again.unchanged, list(again.done)) == (["a"], ["b"])
    assert list(run(tasks, place, force=True).done) == ["a", "b"]
    assert regeneration.usual_minutes(tasks[0], regeneration.read_record(place.record)) < 1.0
    assert regeneration.usual_minutes(writes("never"), {}) == 1.0
    place.record.write_text("damaged")
    assert list(run(tasks, place).done) == ["a", "b"]


def test_code_that_is_used_counts_and_comments_do_not(place: Place) -> None:
    tasks = [writes("a")]
    run(tasks, place)
    changed(place.package / "deeper.py", '"""Words."""\nNUMBER = 1  # one\n')
    changed(place.package / "other.py", "NUMBER = 6\n")
    assert run(tasks, place).unchanged == ["a"]
    changed(place.package / "deeper.py", "NUMBER = 2\n")
    assert list(run(tasks, place).done) == ["a"]
    assert (place.experiments / "results" / "a.txt").read_text() == "2"


def test_what_is_read_comes_before(place: Place) -> None:
    tasks = [writes("page", reads=("results/a*.txt",)), writes("b"), writes("a1"), writes("a2")]
    for jobs in (1, 3):
        assert set(run(tasks, place, force=True, jobs=jobs).done) == {"page", "b", "a1", "a2"}
    for found in (order(place)[:4], order(place)[4:]):
        assert found.index("page.txt") > max(found.index("a1.txt"), found.index("a2.txt"))
    (place.experiments / "results" / "a1.txt").write_text("other")
    assert set(run(tasks, place).done) == {"a1"}  # and as it is written as it was, the page is that of before


def test_a_failure_is_told_and_stops_nothing(place: Place) -> None:
    failing = Task("fails", (("fails.py",),), ())
    silent = Task("silent", (("writes.py", "else.txt"),), ("results/silent.txt",))
    outcome = run([failing, silent, writes("a")], place, jobs=2)
    assert list(outcome.done) == ["a"]
    assert "fails.py ended with exit code 3" in outcome.failed["fails"]
    assert "did not write results/silent.txt" in outcome.failed["silent"]
    assert set(regeneration.read_record(place.record)) == {"a"}
    assert set(run([failing, writes("a")], place).failed) == {"fails"}  # and is tried again


def test_without_its_data_a_task_is_left_out(place: Place, tmp_path: Path) -> None:
    task = writes("a", data=("walks",))
    assert run([task], place).without_data == ["a"]
    (tmp_path / "data" / "walks").mkdir(parents=True)
    there = Place(**{**vars(place), "data": tmp_path / "data"})
    assert list(run([task], there).done) == ["a"]
    assert run([task], there).unchanged == ["a"]
    (tmp_path / "data" / "walks" / "new.csv").write_text("1")
    assert list(run([task], there).done) == ["a"]


def test_every_script_has_a_task_and_every_task_its_scripts() -> None:
    script = experiment("all")
    named = {command[0] for task in script.TASKS for command in task.commands}
    assert all((EXPERIMENTS / name).is_file() for name in named - {"pdr_est"})
    scripts = {path.stem for path in EXPERIMENTS.glob("*.py")}
    assert scripts - {task.name for task in script.TASKS} == script.NOT_RUN
    outputs = [output for task in script.TASKS for output in task.outputs]
    assert len(outputs) == len(set(outputs))


def test_every_recorded_result_is_of_a_task() -> None:
    script = experiment("all")
    outputs = {output for task in script.TASKS for output in task.outputs}
    found = {f"results/{path.name}" for path in (EXPERIMENTS / "results").iterdir() if not path.name.startswith(".")}
    assert found - outputs - {"results/fingerprints.json"} == set()


@pytest.mark.slow
def test_the_fingerprint_of_a_table_holds_the_front_end() -> None:
    """A change of a stage, of a script's helper or of a gait model makes a table old."""
    place = experiment("all").place_with(None)
    files = regeneration.imported_files([place.experiments / "psp_figure3.py"], place)
    names = {path.relative_to(place.package.parent).as_posix() for path in files}
    assert {"experiments/psp_table1.py", "experiments/recorded.py"} < names
    assert "pdr_est/front_end/heading/tie_controller.py" in names
    assert "pdr_est/simulate/carrying/pocket_phone.py" in names
    assert not any(name.startswith(("pdr_est/report/", "pdr_est/cli/")) for name in names)
