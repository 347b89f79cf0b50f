"""No command replaces what it reads, by whatever name, and a failing one leaves an earlier result as it was."""

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cli_recordings import Walk
from cli_runs import refused, run

from pdr_est.cli import COMMANDS, main
from pdr_est.cli.call_paths import OutputPath

FIXES = "time_s,x_m,y_m,sigma_m\n5.0,1.0,0.0,1.0\n9.0,2.0,0.0,1.0\n"
NAMES: dict[str, Callable[[Path], Path]] = {
    "itself": lambda path: path,
    "relative": lambda path: Path(os.path.relpath(path)),
    "roundabout": lambda path: path.parent / "." / "sub" / ".." / path.name,
    "symbolic link": lambda path: linked(path, Path.symlink_to),
    "hard link": lambda path: linked(path, Path.hardlink_to),
}


def linked(path: Path, make: Callable[[Path, Path], None]) -> Path:
    link = path.with_name(f"link-{path.name}")
    make(link, path)
    return link


@pytest.fixture
def inputs(good: Path, tmp_path: Path) -> dict[str, Path]:
    """A recording, and all that may be given beside it."""
    (tmp_path / "sub").mkdir()
    found = {
        name: tmp_path / f"{name}.{suffix}"
        for name, suffix in (("walk", "csv"), ("fixes", "csv"), ("config", "yaml"))
    }
    found["walk"].write_bytes(good.read_bytes())
    found["fixes"].write_text(FIXES, encoding="utf-8")
    found["config"].write_text("steps: {}\n", encoding="utf-8")
    return found


CALLS = {
    "track": ("track", "{walk}", "--fixes", "{fixes}", "--config", "{config}", "--overwrite", "-o"),
    "steps": ("steps", "{walk}", "--config", "{config}", "--overwrite", "-o"),
    "steps, all": ("steps", "{walk}", "--config", "{config}", "--summary"),
    "inspect": ("inspect", "{walk}", "--summary"),
    "inspect, map": ("inspect", "{walk}", "--write-map"),
    "convert": ("convert", "{walk}", "--format", "csv", "--overwrite", "-o"),
    "calibrate": ("calibrate", "{walk}", "--fixes", "{fixes}", "--config", "{config}", "--overwrite", "-o"),
    "benchmark": ("benchmark", "ilc20", "--data", "{walk}", "--config", "{config}", "--json"),
    "smooth": ("smooth", "{walk}", "--fixes", "{fixes}", "--config", "{config}", "--overwrite", "-q", "-o"),
    "smooth, many": ("smooth", "{walk}", "{walk}", "--each", "--config", "{config}", "--overwrite", "-q", "-o"),
    "train-gait": ("train-gait", "--data", "{walk}", "--overwrite", "-o"),
}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("call", CALLS)
def test_no_input_is_replaced(
    call: str, name: str, inputs: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path / "sub")
    read = [path for key, path in inputs.items() if any(f"{{{key}}}" in word for word in CALLS[call])]
    for path in read:
        output = NAMES[name](path)
        before = {one: one.read_bytes() for one in read}
        refused(*(word.format(**inputs) for word in CALLS[call]), output)
        assert {one: one.read_bytes() for one in read} == before
        assert output.samefile(path)
    assert [path.name for path in tmp_path.iterdir() if path.name.endswith(".partial")] == []


def test_what_a_pattern_matches_is_an_input(inputs: dict[str, Path], tmp_path: Path) -> None:
    words = refused("steps", tmp_path / "wal*.csv", "-o", inputs["walk"], "--overwrite")
    assert "is the input" in words


def test_a_file_inside_an_input_folder_is_one_by_any_name(inputs: dict[str, Path], tmp_path: Path) -> None:
    folder = tmp_path / "recording"
    folder.mkdir()
    (folder / "walk.csv").symlink_to(inputs["walk"])
    before = inputs["walk"].read_bytes()
    assert "is the input" in refused("track", folder, "-o", inputs["walk"], "--overwrite")
    assert inputs["walk"].read_bytes() == before


def test_a_table_that_lies_beside_the_recording_and_was_read_is_not_replaced(walk: Walk, tmp_path: Path) -> None:
    """The true positions of OxIOD are found beside the recording, and no option names them."""
    down_g, user_g = np.array([0.0, 0.0, -1.0]), -walk.force / 9.81 - np.array([0.0, 0.0, -1.0])
    rows, zeros = len(walk.time_s), np.zeros((len(walk.time_s), 3))
    columns = [walk.time_s, zeros, walk.rate, np.tile(down_g, (rows, 1)), user_g, zeros + 30.0]
    table, truth = tmp_path / "imu1.csv", tmp_path / "vi1.csv"
    np.savetxt(table, np.column_stack(columns), delimiter=",", fmt="%.6f")
    np.savetxt(truth, np.column_stack([walk.time_s, zeros, zeros, zeros[:, :1], zeros[:, :1] + 1.0]), delimiter=",")
    before = truth.read_bytes()
    assert "has been read by this call" in refused("track", table, "-o", truth, "--overwrite")
    assert truth.read_bytes() == before


@pytest.mark.slow
def test_a_folder_of_results_that_holds_the_recording_is_not_replaced(tmp_path: Path) -> None:
    """`demo` writes its recording into the folder of its results, and `convert` makes recordings that are folders."""
    demo, folder = tmp_path / "demo", tmp_path / "converted"
    assert run("demo", "-q", "-o", demo).exit_code == 0
    walk = demo / "simulated-walk.csv"
    assert run("convert", walk, "-o", folder).exit_code == 0
    before = {path: path.read_bytes() for path in (*demo.iterdir(), *folder.iterdir())}
    assert "holds the input" in refused("smooth", walk, "-o", demo, "--overwrite")
    for call in (("smooth", folder, "-q"), ("convert", folder), ("smooth", "--each", folder, "-q")):
        target = tmp_path if "--each" in call else folder
        result = run(*call, "-o", target, "--overwrite")
        assert result.exit_code == 2
    assert {path: path.read_bytes() for path in (*demo.iterdir(), *folder.iterdir())} == before
    other = tmp_path / "other"
    assert run("smooth", walk, "-o", other, "-q", "--no-report").exit_code == 0
    assert "earlier run" in refused("demo", "-q", "-o", other)  # only an earlier demo is replaced unasked


@pytest.mark.parametrize("text", ["", "not a message\n"])
def test_a_failing_live_walk_leaves_an_earlier_output(text: str, tmp_path: Path) -> None:
    from click.testing import CliRunner

    output = tmp_path / "lines.jsonl"
    output.write_text("earlier\n", encoding="utf-8")
    result = CliRunner().invoke(main, ["track", "-", "-o", str(output), "--overwrite"], input=text)
    assert result.exit_code == 2
    assert output.read_text(encoding="utf-8") == "earlier\n"
    assert [path.name for path in tmp_path.iterdir()] == ["lines.jsonl"]


def test_every_option_for_an_output_has_the_type_of_one() -> None:
    """All other paths are inputs, so that a new option is one at once."""
    named = {"--output", "--summary", "--write-map", "--json"}
    for name in COMMANDS:
        command = main.get_command(main.make_context("pdr-est", [name], resilient_parsing=True), name)
        assert command is not None
        for parameter in command.params:
            is_path = hasattr(parameter.type, "path_type")
            assert not is_path or isinstance(parameter.type, OutputPath) == bool(named & set(parameter.opts))
