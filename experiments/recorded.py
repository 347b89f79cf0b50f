"""Where the scripts write what they found: results/, and the tables of experiments/README.md."""

import json
from collections.abc import Mapping
from pathlib import Path

RESULTS = Path(__file__).parent / "results"
README = Path(__file__).parent / "README.md"


def write(stem: str, text: str, document: Mapping[str, object]) -> None:
    """Print the text, and write it and the numbers to results/STEM.txt and .json."""
    (RESULTS / f"{stem}.json").write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    (RESULTS / f"{stem}.txt").write_text(text, encoding="utf-8")
    print(text, end="")


def write_table(mark: str, table: str, page: Path = README) -> None:
    """Put a table between the two places of a page that have a mark."""
    before, _, after = page.read_text(encoding="utf-8").split(mark)
    page.write_text(f"{before}{mark}\n{table}\n{mark}{after}", encoding="utf-8")
