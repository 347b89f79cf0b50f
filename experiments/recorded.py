"""Shared parts of the scripts: command line, results/ and the tables of experiments/README.md."""

import argparse
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

RESULTS = Path(__file__).parent / "results"
README = Path(__file__).parent / "README.md"


def command_line(description: str | None, options: Mapping[str, Any] = MappingProxyType({})) -> Any:
    """Parse the command line of a script.

    Parameters
    ----------
    description : str
        Docstring of the script.
    options : Mapping
        Option such as "--seed" -> its default, which also sets its type; an option with a list takes several values,
        and `Path` stands for a path that must be given.

    Returns
    -------
    argparse.Namespace
        The values of the options.
    """
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    for flag, default in options.items():
        if default is Path:
            parser.add_argument(flag, type=Path, required=True)
        elif isinstance(default, list):
            parser.add_argument(flag, type=type(default[0]), nargs="+", default=default)
        else:
            parser.add_argument(flag, type=type(default), default=default)
    return parser.parse_args()


def write(stem: str, text: str, document: Mapping[str, object] | Sequence[object]) -> None:
    """Print the text, and write it and the numbers to results/STEM.txt and .json."""
    (RESULTS / f"{stem}.json").write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    (RESULTS / f"{stem}.txt").write_text(text, encoding="utf-8")
    print(text, end="")


def write_table(mark: str, table: str, page: Path = README) -> None:
    """Put a table between the two places of a page that have a mark."""
    before, _, after = page.read_text(encoding="utf-8").split(mark)
    page.write_text(f"{before}{mark}\n{table}\n{mark}{after}", encoding="utf-8")


def markdown_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Format a table as Markdown."""
    return "\n".join(f"| {' | '.join(row)} |" for row in (headings, ["---"] * len(headings), *rows))
