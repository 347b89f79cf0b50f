"""Wrong options, configurations, fixes and output folders are refused in one line before anything is written."""

import errno
import re
from pathlib import Path

import pytest
from cli_recordings import Walk, columns_of, lines_of, save
from cli_runs import refused, run, smooth_refused, smoothed

pytestmark = pytest.mark.usefixtures("without_report")


@pytest.fixture
def outs(tmp_path: Path) -> Path:
    """Where the output folder would lie."""
    return tmp_path / "outs"


# --- the command line ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "pattern"),
    [
        (("--height", "-1"), r"--height: walker\.height_m = -1\.0: .* greater than or equal to 0\.5; .* metres"),
        (("--height", "0"), r"--height: .* the unit is metres"),
        (
            ("--height", "175"),
            r"--height: walker\.height_m = 175\.0: .* less than or equal to 2\.6; the unit is metres",
        ),
        (("--height", "nan"), r"--height: walker\.height_m = nan: Input should be a finite number"),
        (("--height", "1,75"), r"'--height': '1,75' is not a valid float; see pdr-est smooth --help"),
        (("--gender", "robot"), r"'--gender': 'robot' is not one of 'male', 'female'"),
        (("--heading", "nan"), r"'--heading': nan is not a direction: give degrees from -360 to 360"),
        (("--corridors", "nan"), r"'--corridors': nan is not a direction: give degrees from -360 to 360"),
        (
            ("--corridors", "30", "--heading-method", "step-yaw"),
            r"\(--corridors 30\): .* heading\.method = step-yaw \(--heading-method\) .* makes no use: choose",
        ),
        (("--heading", "inf"), r"'--heading': inf is not in the range -360(\.0)?<=x<=360(\.0)?"),
        (("--heading", "north"), r"'--heading': 'north' is not a valid float"),
        (("--start", "1"), r"'--start' requires 2 arguments"),
        (("--start", "nan", "0"), r"--start: start\.x_m = nan: Input should be a finite number"),
        (("--start", "0", "1e300"), r"--start: start\.y_m = 1e\+300: .* less than or equal to 100000000; .* metres"),
        (("--estimator", "kalman"), r"'kalman' is not one of 'dead-reckoning', "),
        (("--attitude", "magic"), r"'magic' is not one of 'auto', 'vqf', 'device'"),
        (("--closed", "--estimator", "dead-reckoning"), r"--closed: start\.closed: dead-reckoning makes no use of"),
        (("--overwrit",), r"No such option '--overwrit'.* '--overwrite'"),
        (("again.csv",), r"again\.csv: .*no such file"),
    ],
    ids=" ".join,
)
def test_options_out_of_range(options: tuple[str, ...], pattern: str, good: Path, outs: Path) -> None:
    line = smooth_refused(good, outs, *options)
    assert re.search(pattern, line), line


def test_what_must_be_given(good: Path) -> None:
    assert refused("smooth", good) == "Missing option '-o' / '--output'; see pdr-est smooth --help"
    assert refused("smooth") == "Missing argument 'RECORDING…'; see pdr-est smooth --help"
    assert refused("smoth", good) == "No such command 'smoth': did you mean smooth?; see pdr-est --help"
    assert (
        "there are inspect, steps, smooth, track, live, calibrate, convert, benchmark, experiment, compare, "
        "evaluate, plan, config, train-gait, demo" in refused("xyz")
    )


# --- the configuration -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "pattern"),
    [
        ("walker:\n  heigth_m: 1.7\n", r": unknown key 'walker\.heigth_m': did you mean 'height_m'\?$"),
        ("walkr:\n  height_m: 1.7\n", r": unknown key 'walkr': did you mean 'walker'\?$"),
        ("colour: 1\n", r": unknown key 'colour': known keys are resample, attitude, "),
        ("1: 2\n", r": unknown key '1': known keys are resample"),
        ("walker:\n  height_m: tall\n", r": walker\.height_m = 'tall': Input should be a valid number"),
        ("walker:\n  height_m: [1.7]\n", r": walker\.height_m = \[1\.7\]: Input should be a valid number"),
        ("walker:\n  height_m: yes\n", r": walker\.height_m = True: is true or false: give a number or a word"),
        (
            "walker:\n  height_m: 175\n",
            r": walker\.height_m = 175: .* less than or equal to 2\.6; the unit is metres",
        ),
        ("walker:\n  height_m: .nan\n", r": walker\.height_m = nan: Input should be a finite number"),
        ("walker:\n  gender: unknown\n", r": walker\.gender = 'unknown': Input should be 'male' or 'female'"),
        ("walker: tall\n", r": walker = 'tall': is a section, give it keys such as 'height_m'"),
        ("walker:\n", r": walker = None: is a section, give it keys such as 'height_m'"),
        ("start:\n  heading_rad: 90\n", r": start\.heading_rad = 90: .* the unit is radians"),
        ("start:\n  x_m: 1.0\n", r": start: x_m and y_m belong together: give both or none"),
        ("resample:\n  rate_hz: 1e9\n", r": resample\.rate_hz = '1e9': .* less than or equal to 1000; .* hertz"),
        ("step_length:\n  range_power_k: 1.0e+300\n", r": step_length\.range_power_k = 1e\+300: .* less than"),
        ("odometry:\n  sigma_length_scale: 1.0e-200\n", r"sigma_length_scale = 1e-200: .* 0 or at least 1e-09"),
        (
            "steps: {detector: mmpdr, mmpdr: {cutoff_hz: 30}}\n",
            r": steps\.mmpdr: cutoff_hz = 30 is not below half of resample\.rate_hz = 50: lower it",
        ),
        ("- a\n- b\n", r": top level = \['a', 'b'\]: is a section, give it keys such as 'resample'"),
        ("hello\n", r": top level = 'hello': is a section"),
        ("a: [1\nb: }\n", r", line 2: is not valid YAML \(.*\): correct it"),
        ("walker:\n\theight_m: 1.7\n", r", line 2: is not valid YAML \(.*'\\t'.*\): correct it"),
        ("walker: {height_m: 1.6}\nwalker: {height_m: 1.7}\n", r", line 2: .*'walker' stands twice"),
        ("walker: !!python/object/apply:os.getcwd []\n", r", line 1: is not valid YAML \(could not determine a con"),
    ],
)
def test_configuration(text: str, pattern: str, good: Path, tmp_path: Path, outs: Path) -> None:
    path = tmp_path / "config.yaml"
    path.write_text(text, encoding="utf-8")
    line = smooth_refused(good, outs, "--config", path)
    assert line.startswith(str(path))
    assert re.search(pattern, line), line


def test_configurations_that_are_none(good: Path, tmp_path: Path, outs: Path) -> None:
    binary = tmp_path / "binary.yaml"
    binary.write_bytes(bytes(range(256)))
    for path, pattern in (
        (tmp_path / "nowhere.yaml", r"nowhere\.yaml: cannot be read \(No such file or directory\): check the path"),
        (tmp_path, r": cannot be read \(Is a directory\): check the path"),
        (binary, r"binary\.yaml: is not UTF-8 text: save it as UTF-8 YAML"),
    ):
        assert re.search(pattern, smooth_refused(good, outs, "--config", path))


def test_an_empty_configuration_is_the_default(good: Path, tmp_path: Path) -> None:
    path = tmp_path / "config.yaml"
    path.write_text("# nothing yet\n", encoding="utf-8")
    smoothed(good, tmp_path / "out", "--config", path)


def test_many_mistakes_make_no_long_line(good: Path, tmp_path: Path, outs: Path) -> None:
    path = save(tmp_path / "config.yaml", [f"key{i}: {{a: 1}}" for i in range(100)])
    line = smooth_refused(good, outs, "--config", path)
    assert line.endswith("; and 97 more")
    assert len(line) < 1000


# --- fixes -----------------------------------------------------------------------------------------------------

HEAD = "time_s,x_m,y_m"


@pytest.mark.parametrize(
    ("lines", "pattern"),
    [
        (
            [HEAD, "1,0,0", "100,8,0"],
            r", line 3: time 100\.000 s is outside the recording \(0\.000 to 1\d\.\d+ s\): use",
        ),
        ([HEAD, "-5,0,0"], r", line 2: time -5\.000 s is outside the recording"),
        ([HEAD, "1,0,nan"], r", line 2: time or position is not a finite number: correct or remove the row"),
        ([HEAD, "1,0,0", ",1,0"], r", line 3: time or position is not a finite number"),
        ([HEAD, "1,0,0", "inf,1,0"], r", line 3: time or position is not a finite number"),
        ([HEAD, "1,here,0"], r", line 2, column 'x_m': 'here' is not a number; correct or remove it"),
        ([HEAD, "1,1e12,0"], r", line 2: position 1e\+12, 0 is beyond 1e\+08 m: give metres"),
        ([HEAD], r": contains no fix: add a row or leave --fixes out"),
        (["when,x_m,y_m", "1,0,0"], r": no column time_s among when, x_m, y_m: name the time column time_s"),
        (
            ["time_s,u,v", "1,0,0"],
            r": needs the columns x_m and y_m, or latitude_deg and longitude_deg; it has time_s, u, v",
        ),
        (["1 0 0"], r": no header line such as time_s,x_m,y_m: add one"),
        ([HEAD, "1718030737,0,0"], r": time_s is Unix time, but that of walk is unknown: give seconds on its own cl"),
        (
            [HEAD, "1718030737000,0,0"],
            r": time_s = 1\.71803e\+12 is not a time in seconds: convert milliseconds to seconds",
        ),
        (
            ["time_s,latitude_deg,longitude_deg", "1,48,11"],
            r": the origin of walk on the Earth is unknown: give x_m and y_m",
        ),
        (
            [HEAD + ",sigma_m", "1,0,0,0"],
            r", line 2: sigma_m = 0: give a positive number of metres, 0\.001 to 100000",
        ),
        ([HEAD + ",sigma_m", "1,0,0,-2"], r", line 2: sigma_m = -2: give a positive number"),
        ([HEAD + ",robust", "1,0,0,2"], r", line 2: robust = 2: give 1 for a fix that may be an outlier, else 0"),
    ],
)
def test_fixes(lines: list[str], pattern: str, good: Path, tmp_path: Path, outs: Path) -> None:
    fixes = save(tmp_path / "fixes.csv", lines)
    line = smooth_refused(good, outs, "--fixes", fixes)
    assert line.startswith(str(fixes))
    assert re.search(pattern, line), line


def test_fixes_that_are_no_table(good: Path, tmp_path: Path, outs: Path) -> None:
    (tmp_path / "empty.csv").touch()
    save(tmp_path / "a.csv", [HEAD, "1,0,0"])
    for choice, pattern in (
        (tmp_path / "nowhere.csv", r"nowhere\.csv: no such file or folder; check the path"),
        (tmp_path / "empty.csv", r"empty\.csv: the file is empty \(0 bytes\)"),
        (tmp_path, r": contains 2 files: give the table of the fixes itself"),
        ("recording", r"walk\.csv: .*: the recording has no position fixes: give a file with --fixes FILE\.csv"),
    ):
        assert re.search(pattern, smooth_refused(good, outs, "--fixes", choice))


def test_fixes_in_other_spellings_are_understood(good: Path, tmp_path: Path) -> None:
    spellings = ("Time_s;X_m;Y_m\n1,5;0,0;0\n9;5,5;0\n", "time_s\tx_m\ty_m\tnote\n1.5\t0\t0\tdoor\n9\t5.5\t0\t\n")
    tracks = []
    for number, text in enumerate(spellings):
        (tmp_path / "fixes.csv").write_text(text, encoding="utf-8")
        smoothed(good, tmp_path / f"out{number}", "--fixes", tmp_path / "fixes.csv")
        tracks.append((tmp_path / f"out{number}" / "track.csv").read_text())
    assert tracks[0] == tracks[1]


def test_fixes_in_unix_time(walk: Walk, tmp_path: Path, outs: Path) -> None:
    """On a recording whose own clock is Unix time, and on one that tells when it began."""
    start_s = 1.7e9
    columns = columns_of(walk, time_s=walk.time_s + start_s)
    own = save(tmp_path / "own.csv", lines_of(columns))
    told = save(
        tmp_path / "told.csv", lines_of({name.replace("time_s", "timestamp"): c for name, c in columns.items()})
    )
    fixes = save(tmp_path / "fixes.csv", [HEAD, f"{start_s + 1},0,0", f"{start_s + 9},5,0"])
    for name, recording in (("own", own), ("told", told)):
        smoothed(recording, tmp_path / name, "--fixes", fixes)
    early = save(tmp_path / "early.csv", [HEAD, f"{start_s - 100},0,0"])
    assert "time 1699999900.000 s is outside the recording (1700000000.000" in smooth_refused(
        own, outs, "--fixes", early
    )
    words = r", line 2: time -100\.000 s is .*\(0\.000 to 14\.\d+ s, counted from Unix time 1700000000\.000 s\)"
    assert re.search(words, smooth_refused(told, outs, "--fixes", early))
    since = save(tmp_path / "since.csv", [HEAD, "1,0,0"])
    assert "is outside the recording (1700000000.000" in smooth_refused(own, outs, "--fixes", since)


def test_fixes_by_latitude_and_longitude(export_zip: Path, tmp_path: Path, outs: Path) -> None:
    head = "time_s,latitude_deg,longitude_deg"
    smoothed(
        export_zip, tmp_path / "out", "--fixes", save(tmp_path / "fixes.csv", [head, "1,48,11", "12,48.0001,11"])
    )
    for row, place in (("1,11,48", "latitude 11, longitude 48"), ("1,148,11", "latitude 148, longitude 11")):
        line = smooth_refused(export_zip, outs, "--fixes", save(tmp_path / "fixes.csv", [head, row]))
        assert re.search(
            rf"line 2: {place} lies far from the recording at 48\.0000, 11\.0000: check whether they are swap", line
        )
    line = smooth_refused(export_zip, outs, "--fixes", save(tmp_path / "fixes.csv", [head, "1,48,inf"]))
    assert "line 2: time or position is not a finite number" in line


# --- the output folder -----------------------------------------------------------------------------------------


def test_output_folders_that_cannot_be(good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "foreign").mkdir()
    (tmp_path / "foreign" / "notes.txt").write_text("mine")
    (tmp_path / "loop").symlink_to("loop")
    monkeypatch.chdir(tmp_path / "foreign")
    before = sorted(tmp_path.rglob("*"))
    for out, pattern in (
        (tmp_path / "file", "is a file, not a folder: choose another output folder"),
        (tmp_path / "foreign", "is the current folder and cannot be replaced"),
        (tmp_path / "no" / "such" / "folder", r"the folder .*such does not exist: create it or choose another one"),
        (tmp_path / "file" / "out", "does not exist: create it"),
        (tmp_path / "loop", "not a usable path .*: choose another one"),
        (tmp_path / ("x" * 300), r"not a usable path .*File name too long.*: choose another one"),
    ):
        assert re.search(pattern, refused("smooth", good, "-o", out))
    monkeypatch.chdir(tmp_path)
    for options in ((), ("--overwrite",)):
        line = refused("smooth", good, "-o", tmp_path / "foreign", *options)
        assert "contains files of other origin (notes.txt): choose a new or an empty folder" in line
    assert sorted(tmp_path.rglob("*")) == before


def test_a_parent_that_is_not_writable(good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(self: Path) -> None:  # the tests may run as root, whom no permission stops
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "mkdir", refuse)
    line = refused("smooth", good, "-o", tmp_path / "out")
    assert line.endswith(
        "out: cannot be written (Permission denied): check that the folder exists and is writable, or choose another "
        "one"
    )


def test_a_folder_of_an_earlier_run_that_was_added_to(good: Path, tmp_path: Path) -> None:
    smoothed(good, tmp_path / "out")
    (tmp_path / "out" / "notes.txt").write_text("mine")
    assert "other origin (notes.txt)" in refused("smooth", good, "-o", tmp_path / "out", "--overwrite")
    assert (tmp_path / "out" / "notes.txt").read_text() == "mine"


def test_a_bad_output_folder_is_told_before_the_recording_is_read(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    assert "is a file" in refused("smooth", tmp_path / "nowhere.csv", "-o", tmp_path / "file")


def test_help_of_every_command_tells_all_its_options() -> None:
    listed = run("--help").stdout
    for command in ("inspect", "smooth", "benchmark", "demo"):
        assert f"  {command} " in listed
        text = run(command, "--help").stdout
        options = re.findall(r"^ +(?:-\w, )?(--[\w-]+)(.*(?:\n {20,}.*)*)", text, flags=re.MULTILINE)
        assert {"--help"} < {name for name, _ in options}
        assert all(re.search(r" {2,}\S|\n {20,}\S", rest) for _, rest in options), text
