"""Turn tutorial scripts into pages: run each cell and show its code, its output and its figures.

A tutorial is a Python script. Its docstring is the title and the introduction. `# %%` begins a cell; the comment
lines right after it are Markdown, the rest is code. This file is a hook of mkdocs, and the tests run the same code.
"""

import contextlib
import io
import re
import tempfile
import traceback
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

DOCS = Path(__file__).resolve().parents[1]
SCRIPTS = tuple(sorted((DOCS / "tutorials").glob("*.py")))


@dataclass
class Page:
    """A rendered tutorial: its Markdown text and its pictures by file name."""

    markdown: str
    pictures: dict[str, bytes] = field(default_factory=dict)


def render(script: Path, folder: Path) -> Page:
    """Run a tutorial in a folder and render it.

    Raises
    ------
    RuntimeError
        If a cell fails; the message names script and cell.
    """
    from matplotlib import pyplot

    pyplot.switch_backend("agg")
    pyplot.close("all")
    introduction, cells = split(script.read_text(encoding="utf-8"))
    title, _, text = introduction.partition("\n")
    parts, page = [f"# {title}\n\n{text.strip()}\n"], Page("")
    space: dict[str, Any] = {"__name__": f"tutorial_{script.stem}"}
    with contextlib.chdir(folder):
        for number, (words, code) in enumerate(cells, start=1):
            parts.append(f"{words}\n")
            if code:
                parts.append(f"```python\n{code}\n```\n")
                output = _run(code, space, f"{script.name}, cell {number}")
                if output.strip():
                    parts.append(f"```text\n{output.rstrip()}\n```\n")
                for name, picture in _figures(f"{script.stem}-{number}"):
                    page.pictures[name] = picture
                    parts.append(f"![{_caption(words)}]({name})\n")
    source = "The page is made from a script that you can download and run: "
    parts.append(f"---\n\n{source}[{script.name}]({script.name}).\n")
    page.markdown = "\n".join(parts)
    return page


def split(text: str) -> tuple[str, list[tuple[str, str]]]:
    """Split a script into its docstring and its cells, each a pair of Markdown and code."""
    head, *bodies = text.split("\n# %%\n")
    cells = []
    for body in bodies:
        lines = body.splitlines()
        count = next((i for i, line in enumerate(lines) if not line.startswith("#")), len(lines))
        words = "\n".join(line.removeprefix("#").removeprefix(" ") for line in lines[:count])
        cells.append((words, "\n".join(lines[count:]).strip()))
    return head.strip().strip('"').strip(), cells


def _run(code: str, space: dict[str, Any], place: str) -> str:
    """Run a cell in the name space of its tutorial and return what it prints."""
    stream = io.StringIO()
    try:
        with contextlib.redirect_stdout(stream):
            exec(compile(code, place, "exec"), space)
    except Exception as error:
        raise RuntimeError(f"{place}: {''.join(traceback.format_exception(error))}") from error
    return stream.getvalue()


def _figures(stem: str) -> Iterator[tuple[str, bytes]]:
    """Save the figures that a cell made, and close them."""
    from matplotlib import pyplot

    for number in pyplot.get_fignums():
        stream = io.BytesIO()
        pyplot.figure(number).savefig(stream, format="png", dpi=110, metadata={"Software": None})
        yield f"{stem}-{number}.png", stream.getvalue()
    pyplot.close("all")


def _caption(words: str) -> str:
    """Take the last sentence of a cell as the text that stands for its picture where that cannot be seen."""
    sentences = re.split(r"(?<=[.:?])\s+", " ".join(words.split()))
    return re.sub(r"[\[\]#`]", "", sentences[-1]).strip(" :.") or "figure"


def on_files(files: Any, config: Any) -> Any:
    """Add the rendered tutorials and their pictures to the site (called by mkdocs)."""
    from mkdocs.structure.files import File

    for script in SCRIPTS:
        with tempfile.TemporaryDirectory() as folder:
            page = render(script, Path(folder))
        files.append(File.generated(config, f"tutorials/{script.stem}.md", content=page.markdown))
        for name, picture in page.pictures.items():
            files.append(File.generated(config, f"tutorials/{name}", content=picture))
    return files
