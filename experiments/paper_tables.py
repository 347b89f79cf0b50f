"""The tables of experiments/README.md that stand beside those of MMPDR and PSP, from the recorded results.

    python experiments/paper_tables.py

Reads experiments/results/*.json, which the scripts of the papers write, and writes the tables between their marks.
Nothing is computed anew.
"""

import argparse
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parent / "results"
README = Path(__file__).parent / "README.md"
_NUMBERS_FROM = 36  # columns of the names in results/mmpdr_table10.txt
MODES = ("HOLDING", "SWING", "POCKET")
# Of the paper, which its tables VIII and IX have of each walk; ours are in the results.
PAPER_HEADINGS = {
    "indoor HOLDING": (14.23, 1.96, 0.75),
    "indoor SWING": (14.8, 4.63, 1.33),
    "indoor POCKET": (10.58, 3.16, 0.71),
    "indoor, all modes": (13.52, 3.41, 1.01),
    "indoor HOLDING, POCKET": (6.43, 0.94, 0.84),
}


def main() -> None:
    """Write the tables into the page."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    text = README.read_text(encoding="utf-8")
    for name, table in paper_tables().items():
        mark = f"<!-- {name} -->"
        before, _, after = text.split(mark)
        text = f"{before}{mark}\n{table}\n{mark}{after}"
    README.write_text(text, encoding="utf-8")


def paper_tables() -> dict[str, str]:
    """Name of the mark -> table as Markdown."""
    tables: Mapping[str, Callable[[], str]] = {
        "mmpdr table 6": mmpdr_table_6,
        "mmpdr table 7": mmpdr_table_7,
        "mmpdr tables 8 and 9, steps": mmpdr_steps,
        "mmpdr tables 8 to 10, headings": mmpdr_headings,
        "mmpdr table 10": mmpdr_table_10,
        "mmpdr offsets": mmpdr_offsets,
        "psp table 1": psp_table_1,
    }
    return {name: table() for name, table in tables.items()}


def mmpdr_table_6() -> str:
    """Right labels of the changes of mode, and missed and false changes."""
    document = result("mmpdr_table6")
    sources = {"paper": document["paper"], **{f"`{name}`": one for name, one in document["methods"].items()}}
    rows = [
        (
            name,
            *(f"{one['changes'][mode][mode]:.2f}" for mode in MODES),
            f"{one['missed']:.2f}",
            f"{one['false']:.2f}",
        )
        for name, one in sources.items()
    ]
    return as_table(("%, of changes", *MODES, "missed", "false"), rows)


def mmpdr_table_7() -> str:
    """Distances of 30 walks of 28 m, the paper's / ours; its models first."""
    document = result("mmpdr_table7")
    rows = []
    for name in sorted(document, key=lambda one: document[one]["paper"] is None):
        paper = document[name]["paper"] or {}
        cells = (beside(paper.get(key), document[name][key]) for key in ("min", "max", "median", "std"))
        rows.append((f"`{name}`", *cells))
    return as_table(("model, m", "minimum", "maximum", "median", "STD"), rows)


def mmpdr_steps() -> str:
    """Steps counted in percent of those taken."""
    rows = result("mmpdr_tables8_9")["rows"]
    return as_table(
        ("walks, steps in %", "paper", "`mmpdr`", "mean error", "`auto`", "mean error"),
        [
            (words, f"{row['paper_ratio']:.2f}", *(f"{row[m][k]:.2f}" for m in ("mmpdr", "auto") for k in _STEPS))
            for words, row in rows.items()
        ],
    )


_STEPS = ("ratio", "error")


def mmpdr_headings() -> str:
    """Median heading error in degrees and mean position error in metres, the paper's and of each chain."""
    rows = result("mmpdr_table10")["rows"]
    chains = tuple(next(iter(rows.values())))
    table = []
    for words, row in rows.items():
        _, median, position = PAPER_HEADINGS.get(words, (None, None, None))
        ours = (f"{row[chain]['heading_median_deg']:.2f} / {row[chain]['position_m']:.2f}" for chain in chains)
        table.append((words, "–" if median is None else f"{median:.2f} / {position:.2f}", *ours))
    return as_table(("walks, deg / m", "paper", *(f"chain `{chain}`" for chain in chains)), table)


def mmpdr_table_10() -> str:
    """Both rows of the table, whose numbers only the text of the results has."""
    text = (RESULTS / "mmpdr_table10.txt").read_text(encoding="utf-8")
    _, *lines = text[text.index("Table X ") :].split("\n\n")[0].splitlines()
    rows, walks = [], ""
    for line in lines:
        words, numbers = line[:_NUMBERS_FROM].split("="), line[_NUMBERS_FROM:].split()
        walks = words[0].replace("paper", "").strip() or walks
        who = f"chain `{words[1].strip()}`" if len(words) > 1 else "paper"
        rows.append((f"{walks}, {who}", *numbers))
    return as_table(("walks", "median, deg", "mean", "95th percentile", "position, %"), rows)


def mmpdr_offsets() -> str:
    """Trained offsets of the walks in all modes."""
    paper = {"SWING": "-1.4, -2.9, 3.0, -4.7, -6.0", "POCKET": "39.7, -6.9, 43.5, -56.5, 111.8, -62.5"}
    ours = result("mmpdr_table10")["trained_offsets_deg"]
    return as_table(
        ("offsets, deg", "paper", "ours"),
        [(mode, paper[mode], ", ".join(f"{offset:.1f}" for offset in ours[mode])) for mode in paper],
    )


def psp_table_1() -> str:
    """Return position errors in percent of the way."""
    document = result("psp_table1")
    methods = tuple(document["blocks"][0]["methods"])
    rows = []
    for trajectory in dict.fromkeys(block["trajectory"] for block in document["blocks"]):
        blocks = [block for block in document["blocks"] if block["trajectory"] == trajectory]
        length_m = blocks[0]["length_m"]
        papers = (100.0 * blocks[0]["methods"][method]["paper_m"] / length_m for method in methods)
        rows.append((f"{trajectory}, paper", *(f"{percent:.2f}" for percent in papers)))
        rows += [
            (
                f"{trajectory}, {block['legs']}",
                *(f"{100.0 * block['methods'][method]['mean_m'] / length_m:.2f}" for method in methods),
            )
            for block in blocks
        ]
    return as_table(("trajectory, % of the way", *(f"`{method}`" for method in methods)), rows)


def beside(paper: float | None, ours: float) -> str:
    """The paper's number / ours."""
    return f"{'–' if paper is None else f'{paper:.2f}'} / {ours:.2f}"


def result(stem: str) -> dict[str, Any]:
    """A recorded document."""
    document: dict[str, Any] = json.loads((RESULTS / f"{stem}.json").read_text(encoding="utf-8"))
    return document


def as_table(titles: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """As Markdown."""
    return "\n".join(f"| {' | '.join(row)} |" for row in (titles, ("---",) * len(titles), *rows))


if __name__ == "__main__":
    main()
