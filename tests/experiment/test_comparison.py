"""Comparing the results of experiments: read, paired, written."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from pdr_est.errors import ConfigError, OutputError
from pdr_est.experiment.results.comparison import as_csv, as_markdown, compare_variants, read_values
from pdr_est.io.writers.parquet import write_parquet

ROWS = [  # walk, track, variant, metric, value
    ("a", "1L", "x", "error_open_m", 2.0),
    ("a", "2R", "x", "error_open_m", 4.0),
    ("a", "1L", "y", "error_open_m", 1.0),
    ("a", "2R", "y", "error_open_m", 1.0),
    ("b", "1L", "x", "error_open_m", 5.0),
    ("b", "1L", "y", "error_open_m", 6.0),
    ("c", "1L", "x", "error_open_m", 5.0),
    ("c", "1L", "y", "error_open_m", None),
]


@pytest.fixture
def results(tmp_path: Path) -> Path:
    folder = tmp_path / "first"
    folder.mkdir()
    walk, track, variant, metric, value = zip(*ROWS, strict=True)
    texts = {"walk": walk, "track": track, "variant": variant, "metric": metric}
    write_parquet(folder / "results.parquet", texts, {"value": value})
    return folder


def test_tracks_of_a_walk_count_once_and_missing_values_not_at_all(results: Path) -> None:
    (pair,) = compare_variants(read_values([results]))
    assert (pair.first, pair.second, pair.n) == ("x", "y", 2)
    assert pair.difference == pytest.approx(((1.0 - 3.0) + (6.0 - 5.0)) / 2.0)
    assert (pair.first_wins, pair.second_wins) == (1, 1)


def test_several_folders_are_told_apart(results: Path, tmp_path: Path) -> None:
    second = tmp_path / "second"
    second.mkdir()
    (second / "results.parquet").write_bytes((results / "results.parquet").read_bytes())
    pairs = compare_variants(read_values([results, second]), reference="first:x")
    assert [(pair.first, pair.second) for pair in pairs] == [
        ("first:x", "first:y"),
        ("first:x", "second:x"),
        ("first:x", "second:y"),
    ]
    assert pairs[1].ties == pairs[1].n == 3


def test_folders_of_one_name_are_told_apart_by_their_paths(results: Path, tmp_path: Path) -> None:
    second = tmp_path / "other" / "first"
    second.mkdir(parents=True)
    (second / "results.parquet").write_bytes((results / "results.parquet").read_bytes())
    names = set(read_values([results, second])["error_open_m"])
    assert names == {f"{folder}:{variant}" for folder in (results, second) for variant in "xy"}


def test_walks_of_one_name_that_differ_are_not_compared(results: Path, tmp_path: Path) -> None:
    second = tmp_path / "second"
    second.mkdir()
    (second / "results.parquet").write_bytes((results / "results.parquet").read_bytes())
    for folder, checksum in ((results, "1"), (second, "2")):
        document = {"data": {}, "scenarios": {"a": checksum}}
        (folder / "provenance.json").write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(OutputError, match=r"first and .*second: a is not the same in both"):
        read_values([results, second])


def test_the_tables_hold_the_same_numbers(results: Path) -> None:
    pairs = compare_variants(read_values([results]))
    cells = "error_open_m,m,x,y,2,4.0000,3.5000,-0.5000,-2.0000,1.0000,1,1,0"
    assert as_csv(pairs).splitlines()[1] == cells
    assert as_markdown(pairs).splitlines()[2] == "| " + cells.replace(",", " | ") + " |"


def test_names_of_variants_are_neither_html_nor_formulas(results: Path) -> None:
    (pair, *_) = compare_variants(read_values([results]))
    hostile = replace(pair, first="<script>alert(1)</script>|[x](http://y)", second="=HYPERLINK(1)")
    row = as_markdown([hostile]).splitlines()[2]
    assert "<" not in row
    assert "\\|\\[x\\](http://y)" in row
    assert ",'=HYPERLINK(1)," in as_csv([hostile])


def test_unknown_names_are_told_with_the_nearest(results: Path, tmp_path: Path) -> None:
    values = read_values([results])
    with pytest.raises(ConfigError, match="unknown metric 'error_opn_m': did you mean 'error_open_m'"):
        read_values([results], metrics=("error_opn_m",))
    with pytest.raises(ConfigError, match=r"unknown track '2L': (did you mean|known are)"):
        read_values([results], track="2L")
    with pytest.raises(ConfigError, match="first: is given twice"):
        read_values([results, results.parent / "first"])
    with pytest.raises(ConfigError, match="unknown variant 'z': known are x, y"):
        compare_variants(values, reference="z")
    with pytest.raises(OutputError, match=r"holds no results.parquet: run `pdr-est experiment"):
        read_values([tmp_path])


def test_one_track_of_several(results: Path) -> None:
    (pair,) = compare_variants(read_values([results], track="2R"))
    assert (pair.n, pair.mean_first, pair.mean_second) == (1, 4.0, 1.0)


def test_metrics_of_different_fixes_are_not_compared(results: Path, tmp_path: Path) -> None:
    """At held-out positions only; what needs no fixes is the same with any."""
    second = tmp_path / "second"
    second.mkdir()
    table = {"walk": "ab", "track": "11", "variant": "xx", "metric": ["error_heldout_m", "error_open_m"]}
    for folder, every in ((results, 3), (second, 6)):
        write_parquet(folder / "results.parquet", table, {"value": [1.0, 2.0]})
        (folder / "config.yaml").write_text(f"fixes: {{protocol: every, every: {every}}}\n", encoding="utf-8")
    with pytest.raises(OutputError, match=r"first and .*second: error_heldout_m are of different fixes: .*--metric"):
        read_values([results, second])
    assert set(read_values([results, second], metrics=("error_open_m",))) == {"error_open_m"}
    assert set(read_values([second])) == {"error_heldout_m", "error_open_m"}


def test_one_variant_is_nothing_to_compare(results: Path) -> None:
    values = {"error_open_m": {"x": read_values([results])["error_open_m"]["x"]}}
    with pytest.raises(ConfigError, match="one variant only: give several"):
        compare_variants(values)


def test_another_table_is_refused(tmp_path: Path) -> None:
    write_parquet(tmp_path / "results.parquet", {"colour": ["red"]}, {})
    with pytest.raises(OutputError, match=r"results.parquet: has no column 'metric': it is none of"):
        read_values([tmp_path])
