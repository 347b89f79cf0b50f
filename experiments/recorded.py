"""Shared parts of the scripts: command line, results/, and the tables of README.md and paper-details.md here."""

import argparse
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from pdr_est.output.atomic_output import write_text
from pdr_est.output.file_lock import locked

RESULTS = Path(__file__).parent / "results"
README = Path(__file__).parent / "README.md"
DETAILS = Path(__file__).parent / "paper-details.md"


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
    """Print the text, and write it and the numbers to results/STEM.txt and .json, each complete or not at all."""
    write_text(RESULTS / f"{stem}.json", json.dumps(document, indent=2) + "\n")
    write_text(RESULTS / f"{stem}.txt", text)
    print(text, end="")


def write_table(mark: str, table: str, page: Path = DETAILS) -> None:
    """Put a table between the two places of a page that have a mark; other scripts may write others meanwhile."""
    with locked(page):
        before, _, after = page.read_text(encoding="utf-8").split(mark)
        write_text(page, f"{before}{mark}\n{table}\n{mark}{after}")


def markdown_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Format a table as Markdown."""
    return "\n".join(f"| {' | '.join(row)} |" for row in (headings, ["---"] * len(headings), *rows))


def table_beside_real(
    kinds: Mapping[str, Mapping[str, Sequence[Any]]], measures: Mapping[str, Callable[[Any], float]], what: str
) -> str:
    """Tabulate medians over real and over simulated walks of each kind, with the 10th and 90th percentile."""
    lines = [f"{'median (10th to 90th percentile)':46}{'real':>24}{'simulated':>24}"]
    for kind, walks in kinds.items():
        lines.append(f"{kind}: {len(walks['real'])} real, {len(walks['simulated'])} simulated {what}")
        for words, measure in measures.items():
            cells = []
            for source in ("real", "simulated"):
                low, middle, high = np.percentile([measure(walk) for walk in walks[source]], [10, 50, 90])
                cells.append(f"{middle:8.2f} ({low:.2f} to {high:.2f})")
            lines.append(f"  {words:44}" + "".join(f"{cell:>24}" for cell in cells))
    return "\n".join(lines) + "\n"
