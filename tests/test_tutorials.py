"""The tutorials run from beginning to end, and their pages show what they printed and drew."""

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest
from documents import ROOT, TUTORIALS

LARGEST_PICTURE_BYTES = 150_000
PRINTED = {
    "from-a-recording-to-a-map": (
        "Recording('walk': plain CSV, devices 'device', 126.5 s)",
        "208 steps; the simulated walker made 208",
        "Track(factor-graph, smoothed: 209 poses of device, ",
        "LineString with 209 points, from [8.54",
    ),
    "compare-two-estimators": (
        "HOLDING-0.csv",
        "report.html",
        "│ POCKET-3  ┆ graph ",
        "error_heldout_m (m), ideal value 0",
    ),
}
PICTURES = {"from-a-recording-to-a-map": 3, "compare-two-estimators": 1}


def hook(name: str) -> ModuleType:
    """Load a hook of the documentation site, which is no part of any package."""
    spec = importlib.util.spec_from_file_location(f"hook_{name}", ROOT / "docs" / "hooks" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    "script",
    [
        pytest.param(script, marks=[pytest.mark.slow] if script.stem == "compare-two-estimators" else [])
        for script in TUTORIALS
    ],
    ids=lambda script: script.stem,
)
def test_a_tutorial_runs_and_becomes_a_page(script: Path, tmp_path: Path) -> None:
    page = hook("tutorials").render(script, tmp_path)
    title = script.read_text(encoding="utf-8").split("\n")[0].removeprefix('"""')
    assert page.markdown.startswith(f"# {title}\n")
    for line in PRINTED[script.stem]:
        assert line in page.markdown
    assert len(page.pictures) == PICTURES[script.stem]
    for name, picture in page.pictures.items():
        assert f"]({name})" in page.markdown
        assert 5_000 < len(picture) < LARGEST_PICTURE_BYTES
    assert page.markdown.count("```") % 2 == 0


def test_every_tutorial_is_known() -> None:
    assert {script.stem for script in TUTORIALS} == PRINTED.keys() == PICTURES.keys()


def test_a_cell_that_fails_is_named(tmp_path: Path) -> None:
    script = tmp_path / "broken.py"
    script.write_text('"""Title\n\nText.\n"""\n\n# %%\n# Good.\n\nx = 1\n\n# %%\n# Bad.\n\nprint(x / 0)\n')
    with pytest.raises(RuntimeError, match=r"broken\.py, cell 2: (.|\n)*ZeroDivisionError"):
        hook("tutorials").render(script, tmp_path)


def test_code_is_split_from_words() -> None:
    words = "# ## Head\n#\n# Words.\n\n"
    code = "x = 1  # one\n# a comment of the code"
    text = f'"""Title\n\nText.\n"""\n\n# %%\n{words}{code}\n\n# %%\n# Last words.\n'
    introduction, cells = hook("tutorials").split(text)
    assert introduction == "Title\n\nText."
    assert cells == [("## Head\n\nWords.", code), ("Last words.", "")]


def test_pages_from_elsewhere_have_their_pictures() -> None:
    pages = hook("repository_pages")
    for source in pages.PAGES.values():
        for picture in pages.linked_pictures(ROOT / source):
            assert (ROOT / source).parent.joinpath(picture).is_file()
    assert "results/mmpdr_figure10.png" in pages.linked_pictures(ROOT / "experiments" / "README.md")


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ('<a href="https://example.org">a link to follow</a>', []),
        ('<script src="https://example.org/a.js"></script>', ["page.html: https://example.org/a.js"]),
        ('<img alt="x" src="//example.org/a.png">', ["page.html: //example.org/a.png"]),
        ('<link rel="stylesheet" href="https://example.org/a.css">', ["page.html: https://example.org/a.css"]),
        ('<link href="https://example.org" rel="canonical">', []),
        (
            "<style>@font-face {src: url(https://example.org/a.woff2)}</style>",
            ["page.html: https://example.org/a.woff2"],
        ),
        ('<script src="assets/a.js"></script><img src="a.png">', []),
    ],
)
def test_what_a_page_loads_from_outside_is_found(text: str, found: list[str], tmp_path: Path) -> None:
    (tmp_path / "page.html").write_text(text)
    assert list(hook("offline_pages").external_loads(tmp_path)) == found


def test_the_theme_is_told_to_load_no_fonts() -> None:
    settings = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert re.search(r"^  font: false", settings, flags=re.MULTILINE)
    assert "docs/hooks/offline_pages.py" in settings
