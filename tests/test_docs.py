"""Every code block of the README and of docs/ is run or checked, in a folder where `make demo` has run.

The blocks of a page run in the order in which they stand, in a folder of the page's own.
"""

import re
import runpy
import shlex
import shutil
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import yaml
from click.testing import CliRunner
from documents import LANGUAGES, PAGES, ROOT, TUTORIALS, Block, blocks_of, missing_lines, prose_of

import pdr_est
from pdr_est import read
from pdr_est.cli import main
from pdr_est.config import Config, config_to_dict, load_config
from pdr_est.estimators import ESTIMATORS
from pdr_est.experiment import load_experiment
from pdr_est.experiment.suites import SUITES
from pdr_est.experiment.variants.axes import AXES
from pdr_est.front_end.heading import HEADINGS
from pdr_est.io.formats.registry import FORMATS
from pdr_est.io.side_tables.position_fixes import read_position_fixes
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.mapping_file import load_mapping
from pdr_est.io.tables.quantities import Quantity

BLOCKS = [block for page in PAGES for block in blocks_of(page)]
README = (ROOT / "README.md").read_text(encoding="utf-8")
FIRST_PAGES = ("README", "getting-started", "own-recording", "python")
"""Pages whose blocks the fast tests run; what a block needs may stand in an earlier one of its page."""
LARGEST_PICTURE_BYTES = 150_000
MOST_README_LINES = 200
GENERATED = ("changelog.md", "papers.md")  # pages of the site that lie elsewhere in the repository


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The output of the demo."""
    folder = tmp_path_factory.mktemp("demo")
    result = CliRunner().invoke(main, ["demo", "-o", str(folder / "demo-out")])
    assert result.exit_code == 0, result.output
    return folder / "demo-out"


@pytest.fixture(scope="module")
def folder_of(demo: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[Path], Path]:
    """The folder that the blocks of a page run in: with the output of the demo, and the experiment files."""
    folders: dict[Path, Path] = {}

    def folder(page: Path) -> Path:
        if page not in folders:
            folders[page] = tmp_path_factory.mktemp(page.stem)
            shutil.copytree(demo, folders[page] / "demo-out")
            shutil.copytree(ROOT / "configs", folders[page] / "configs")
        return folders[page]

    return folder


@pytest.mark.parametrize(
    "block",
    [
        pytest.param(block, id=block.name, marks=[] if block.page.stem in FIRST_PAGES else [pytest.mark.slow])
        for block in BLOCKS
    ],
)
def test_block(block: Block, folder_of: Callable[[Path], Path], monkeypatch: pytest.MonkeyPatch) -> None:
    assert block.language in LANGUAGES, f"{block.name}: name the language of the block, one of {LANGUAGES}"
    folder = folder_of(block.page)
    monkeypatch.chdir(folder)
    monkeypatch.syspath_prepend(str(folder))  # as Python does with the folder of a script
    if block.file_name is not None:
        (folder / block.file_name).write_text(block.code, encoding="utf-8")
    match block.language:
        case "console":
            for command, lines in block.commands:
                run_command(command, lines)
        case "python":
            # A file and not exec(): what it defines can be pickled.
            script = folder / (block.file_name or "block.py")
            script.write_text(block.code, encoding="utf-8")
            runpy.run_path(str(script), run_name=script.stem)
        case "yaml":
            check_yaml(block, folder)
        case "csv":
            check_csv(block, folder)


def run_command(command: str, lines: tuple[str, ...]) -> None:
    """Run what is ours; of make and of scripts, which take long, check that they are there and know the options."""
    program, *words = shlex.split(command)
    if program == "pdr-est":
        # Many processes are tested elsewhere, and here they take longer than the work.
        one_process = ["1" if before == "--workers" else word for before, word in pairwise(["", *words])]
        if words[0] == "experiment" and not lines:  # whose output does not name the number of walks
            one_process += ["--limit", "3"]
        result = CliRunner().invoke(main, one_process)
        assert result.exit_code == 0, f"{command}: {result.output}"
        assert missing_lines(lines, result.output) == [], result.output
    elif program == "make":
        makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
        for target in words:
            assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE), f"no make target {target}"
    elif program == "python":
        check_script(words[0], words[1:])
    elif program.startswith("_PDR_EST_COMPLETE="):
        variable, shell = program.split("=")
        rules = CliRunner().invoke(main, words[1:-2], prog_name=words[0], env={variable: shell}).output
        assert re.search(rf"^ *complete .*\b{words[0]}\b", rules, flags=re.MULTILINE), rules
    else:
        raise AssertionError(f"{command}: neither pdr-est nor its completion, nor make nor python")


def check_script(path: str, words: list[str]) -> None:
    script = (ROOT / path).read_text(encoding="utf-8")
    for option in (word for word in words if word.startswith("--")):
        assert f'"{option}"' in script, f"{path} knows no {option}"


def check_yaml(block: Block, folder: Path) -> None:
    path = folder / "configs" / (block.file_name or "of-the-page.yaml")
    path.write_text(block.code, encoding="utf-8")
    if re.search(r"^data:", block.code, flags=re.MULTILINE):
        assert len(load_experiment(path).variants) > 1, "an experiment compares something"
    elif re.search(r"^(?:accelerometer|files):", block.code, flags=re.MULTILINE):
        assert load_mapping(path).has_motion
    else:
        load_config(path)


def check_csv(block: Block, folder: Path) -> None:
    """The header of a recording, or a table of position fixes, which commands that follow find as fixes.csv."""
    header, *rows = block.code.splitlines()
    if rows:
        (folder / "fixes.csv").write_text(block.code, encoding="utf-8")
        assert len(read_position_fixes(folder / "fixes.csv", read("demo-out/simulated-walk.csv"))) == len(rows)
        return
    known = understand_titles(header.split(","))
    assert known.has_time
    assert Quantity.FORCE in known.columns
    assert known.unused == (), "an unknown column"


def test_the_pages_have_code_of_every_kind() -> None:
    assert {block.language for block in BLOCKS} >= {"console", "python", "yaml", "csv"}
    assert len([block for block in BLOCKS if block.language == "python"]) >= 6
    for page in PAGES:
        assert page.read_text(encoding="utf-8").count("```") == 2 * len(blocks_of(page)), page


def test_a_line_that_was_not_printed_is_noticed() -> None:
    assert missing_lines(["two  words", "…", "", "gone"], "some\ntwo words\n") == ["gone"]


@pytest.mark.parametrize(
    ("command", "lines"),
    [
        ("pdr-est config show no-such-file.yaml", ()),
        ("pdr-est --version", ("a line that is not printed",)),
        ("make nothing", ()),
        ("python experiments/psp_table1.py --no-such-option", ()),
        ("rm everything", ()),
    ],
)
def test_a_wrong_command_is_noticed(command: str, lines: tuple[str, ...]) -> None:
    with pytest.raises(AssertionError):
        run_command(command, lines)


@pytest.mark.parametrize("header", ["time_s,acc_x_mps2", "time_s,acc_x_mps2,acc_y_mps2,acc_z_mps2,colour"])
def test_a_wrong_header_is_noticed(header: str, tmp_path: Path) -> None:
    with pytest.raises(AssertionError):
        check_csv(Block(ROOT / "README.md", 1, "csv", f"{header}\n"), tmp_path)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_what_a_page_names_exists(page: Path) -> None:
    prose = prose_of(page)
    for path in re.findall(r"`((?:pdr_est|configs|experiments|docs|tests|models)/[\w./-]+)`", prose):
        assert (ROOT / path).exists(), f"{page.name}: {path}"
    for target in re.findall(r"\]\((?!https?://|#)([^)#]+)", prose):
        script = (page.parent / target).with_suffix(".py")  # tutorials become pages when the site is built
        generated = page.parent == ROOT / "docs" and target in GENERATED
        assert generated or script in TUTORIALS or (page.parent / target).exists(), f"{page.name}: {target}"
    for path, words in re.findall(r"`python (experiments/\w+\.py)([^`]*)`", prose):
        check_script(path, words.split())


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_settings_that_a_page_names_exist(page: Path) -> None:
    settings = config_to_dict(Config())
    for name in re.findall(rf"`((?:{'|'.join(settings)})\.(?!csv)[a-z_.]+)[:`]", prose_of(page)):
        section: Any = settings
        for key in name.split("."):
            assert isinstance(section, dict), f"{page.name}: {name}"
            assert key in section, f"{page.name}: {name}"
            section = section[key]


def test_the_readme_is_short() -> None:
    assert README.count("\n") <= MOST_README_LINES


def test_every_page_is_reached_from_the_readme() -> None:
    reference = ROOT / "docs" / "api"  # which only the built site can show
    recorders = ROOT / "docs" / "recorders"
    pages = [page for page in PAGES[1:] if page.parent not in (reference, recorders) and page.name != "index.md"]
    for page in [*pages, *TUTORIALS]:
        assert f"]({page.relative_to(ROOT)})" in README, page.name
    index = (recorders / "index.md").read_text(encoding="utf-8")
    assert [page.name for page in recorders.glob("[!i]*.md") if f"]({page.name})" not in index] == []
    assert "](recorders/index.md)" in (ROOT / "docs" / "recorder-formats.md").read_text(encoding="utf-8")


def test_every_page_is_in_the_navigation_of_the_site() -> None:
    navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    docs = ROOT / "docs"
    pages = [page.relative_to(docs) for page in PAGES if page.is_relative_to(docs)]
    tutorials = [script.relative_to(docs).with_suffix(".md") for script in TUTORIALS]
    missing = [str(page) for page in [*pages, *tutorials] if not re.search(rf"[ :-] {page}\n", navigation)]
    assert missing == []
    assert yaml.safe_load(navigation)["strict"] is True


def test_the_reference_has_every_public_name() -> None:
    page = (ROOT / "docs" / "api" / "index.md").read_text(encoding="utf-8")
    named = re.findall(r"^::: pdr_est\.(\w+)$", page, flags=re.MULTILINE)
    assert sorted([*named, "__version__"]) == sorted(pdr_est.__all__)


def test_the_reference_has_every_package() -> None:
    pages = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs" / "api").glob("*.md"))
    documented = set(re.findall(r"^::: pdr_est\.(\w+)$", pages, flags=re.MULTILINE))
    # These serve the command line and are no library.
    internal = {"cli", "experiment", "output", "performance", "report"}
    packages = {path.parent.name for path in (ROOT / "pdr_est").glob("*/__init__.py")}
    assert packages - internal - documented == set()


def test_pictures_are_small() -> None:
    pictures = list((ROOT / "docs" / "pictures").iterdir())
    assert pictures
    for picture in pictures:
        assert picture.stat().st_size <= LARGEST_PICTURE_BYTES, picture
        assert any(picture.name in page.read_text(encoding="utf-8") for page in PAGES), picture


@pytest.mark.parametrize(
    ("page", "names"),
    [
        ("recorder-formats.md", tuple(known.NAME for known in FORMATS)),
        ("headings.md", tuple(f"`{name}`" for name in HEADINGS)),
        ("writing-an-estimator.md", tuple(f"`{name}`" for name in ESTIMATORS)),
    ],
    ids=("formats", "headings", "estimators"),
)
def test_pages_are_complete(page: str, names: tuple[str, ...]) -> None:
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    assert [name for name in names if name not in text] == []


def test_benchmark_table_is_that_of_the_recorded_results() -> None:
    script = runpy.run_path(str(ROOT / "experiments" / "benchmark_tables.py"))
    for page in script["PAGES"]:
        assert script["readme_table"]() in page.read_text(encoding="utf-8"), page


def test_latency_table_is_computed() -> None:
    script = runpy.run_path(str(ROOT / "experiments" / "latency_tables.py"))
    assert script["latency_tables"]() in (ROOT / "docs" / "latency.md").read_text(encoding="utf-8")


def test_tables_of_the_papers_are_those_of_the_recorded_results() -> None:
    script = runpy.run_path(str(ROOT / "experiments" / "paper_tables.py"))
    for page, tables in (("README.md", "overview_tables"), ("paper-details.md", "paper_tables")):
        text = (ROOT / "experiments" / page).read_text(encoding="utf-8")
        for name, table in script[tables]().items():
            assert f"<!-- {name} -->\n{table}\n<!-- {name} -->" in text, f"run experiments/paper_tables.py: {name}"


def test_the_recorded_comparisons_are_of_known_suites_and_settings() -> None:
    script = runpy.run_path(str(ROOT / "experiments" / "benchmark_tables.py"))
    assert set(script["COMPARED"]) <= {suite.name for suite in SUITES}
    assert {axis for axes in script["COMPARED"].values() for axis in axes} <= {axis.name for axis in AXES}
