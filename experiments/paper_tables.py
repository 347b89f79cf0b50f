"""Make the tables of experiments/README.md and paper-details.md from the recorded results.

    python experiments/paper_tables.py

Reads experiments/results/, which the scripts of the papers write, and writes the tables between their marks. Nothing
is computed anew.
"""

from collections.abc import Callable, Mapping

from overview import MODES, overview_tables, result, table_10_rows
from recorded import README, command_line, markdown_table, write_table

# Of the paper, which its tables VIII and IX have of each walk; ours are in the results.
PAPER_HEADINGS = {
    "indoor HOLDING": (14.23, 1.96, 0.75, 100.04),
    "indoor SWING": (14.8, 4.63, 1.33, 98.37),
    "indoor POCKET": (10.58, 3.16, 0.71, 96.86),
    "indoor, all modes": (13.52, 3.41, 1.01, 98.01),
    "indoor HOLDING, POCKET": (6.43, 0.94, 0.84, 96.89),
}


def main() -> None:
    """Write the tables into the pages."""
    command_line(__doc__)
    for name, table in overview_tables().items():
        write_table(f"<!-- {name} -->", table, README)
    for name, table in paper_tables().items():
        write_table(f"<!-- {name} -->", table)


def paper_tables() -> dict[str, str]:
    """Make the tables of paper-details.md: name of the mark -> Markdown."""
    tables: Mapping[str, Callable[[], str]] = {
        "mmpdr table 6": mmpdr_table_6,
        "mmpdr table 7": mmpdr_table_7,
        "mmpdr tables 8 and 9, steps": mmpdr_steps,
        "mmpdr tables 8 to 10, headings": mmpdr_headings,
        "mmpdr table 10": mmpdr_table_10,
        "mmpdr offsets": mmpdr_offsets,
        "mmpdr causes": mmpdr_causes,
        "psp table 1": psp_table_1,
        "psp figure 3": psp_figure_3,
        "robust dr figure 4": robust_dr_figure_4,
    }
    return {name: table() for name, table in tables.items()}


def mmpdr_table_6() -> str:
    """Tabulate the right labels after changes of mode, and missed and false changes."""
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
    return markdown_table(("%, of changes", *MODES, "missed", "false"), rows)


def mmpdr_table_7() -> str:
    """Tabulate distances of 30 walks of 28 m, paper / ours; the models of the paper come first."""
    document = result("mmpdr_table7")
    rows = []
    for name in sorted(document, key=lambda one: document[one]["paper"] is None):
        paper = document[name]["paper"] or {}
        cells = (beside(paper.get(key), document[name][key]) for key in ("min", "max", "median", "std"))
        rows.append((f"`{name}`", *cells))
    return markdown_table(("model, m", "minimum", "maximum", "median", "STD"), rows)


def mmpdr_steps() -> str:
    """Tabulate the steps counted in percent of those taken."""
    rows = result("mmpdr_tables8_9")["rows"]
    return markdown_table(
        ("walks, steps in %", "paper", "`mmpdr`", "mean error", "`auto`", "mean error"),
        [
            (words, f"{row['paper_ratio']:.2f}", *(f"{row[m][k]:.2f}" for m in ("mmpdr", "auto") for k in _STEPS))
            for words, row in rows.items()
        ],
    )


_STEPS = ("ratio", "error")


def mmpdr_headings() -> str:
    """Tabulate median heading error, deg, mean position error, m, and distance, %, of the paper and of each chain."""
    rows = result("mmpdr_table10")["rows"]
    chains = tuple(next(iter(rows.values())))
    table = []
    for words, row in rows.items():
        paper = PAPER_HEADINGS.get(words)
        ours = (
            f"{one['heading_median_deg']:.2f} / {one['position_m']:.2f} / {one['travelled_percent']:.1f}"
            for one in (row[chain] for chain in chains)
        )
        table.append((words, "–" if paper is None else f"{paper[1]:.2f} / {paper[2]:.2f} / {paper[3]:.1f}", *ours))
    return markdown_table(("walks, deg / m / %", "paper", *(f"chain `{chain}`" for chain in chains)), table)


def mmpdr_table_10() -> str:
    """Tabulate both rows of Table X."""
    titles = (
        "walks",
        "median, deg",
        "mean",
        "95th percentile",
        "distance, %",
        "position, %",
        "error over sigma, rms",
    )
    rows = [(words, *numbers) for words, numbers in table_10_rows().items()]
    return markdown_table(titles, [(*row, *["–"] * (len(titles) - len(row))) for row in rows])


def mmpdr_causes() -> str:
    """Tabulate the numbers of MMPDR's chain with parts replaced by the truth."""
    rows = result("mmpdr_causes")["rows"]
    titles = ("steps", "to the end", "+ eq. 8", "position", "lengths", "headings", "median, deg", "95 %, deg")
    headings = (
        "walks, %",
        "steps",
        "none behind the last heel strike",
        "and transitions true",
        "position",
        "lengths true",
        "headings true",
        "heading error, deg",
        "95th percentile",
        "walks",
    )
    return markdown_table(
        headings,
        [(words, *(f"{row[title]:.2f}" for title in titles), f"{row['walks']}") for words, row in rows.items()],
    )


def mmpdr_offsets() -> str:
    """Tabulate the trained offsets of the walks in all modes."""
    paper = {"SWING": "-1.4, -2.9, 3.0, -4.7, -6.0", "POCKET": "39.7, -6.9, 43.5, -56.5, 111.8, -62.5"}
    ours = result("mmpdr_table10")["trained_offsets_deg"]
    return markdown_table(
        ("offsets, deg", "paper", "ours"),
        [(mode, paper[mode], ", ".join(f"{offset:.1f}" for offset in ours[mode])) for mode in paper],
    )


def psp_table_1() -> str:
    """Tabulate the return position errors, mean and median, in percent of the path."""
    blocks = result("psp_table1")["blocks"]
    methods = tuple(blocks[0]["methods"])
    rows = []
    for trajectory in dict.fromkeys(block["trajectory"] for block in blocks):
        own = [block for block in blocks if block["trajectory"] == trajectory]
        papers_m = [own[0]["methods"][method]["paper_m"] for method in methods]
        papers = ("–" if one is None else f"{100.0 * one / own[0]['length_m']:.2f}" for one in papers_m)
        rows.append((f"{trajectory}, the paper's", *papers))
        for block in own:
            cells = (block["methods"][method] for method in methods)
            numbers = (f"{cell['percent']:.2f} ({cell['median_percent']:.2f})" for cell in cells)
            rows.append((f"{trajectory}, {block['set_up']}", *numbers))
    return markdown_table(("trajectory, % of the way", *(f"`{method}`" for method in methods)), rows)


def psp_figure_3() -> str:
    """Tabulate the return position errors of the paths that are drawn, percent of the path."""
    walks = result("psp_figure3")["return_error_percent"]
    methods = [key for key in walks[0] if key not in ("trajectory", "set_up", "way")]
    rows = [
        (f"{one['trajectory']}, {one['way']}, {one['set_up']}", *(f"{one[method]:.2f}" for method in methods))
        for one in walks
    ]
    return markdown_table(("left pocket, % of the way", *(f"`{method}`" for method in methods)), rows)


def robust_dr_figure_4() -> str:
    """Tabulate the errors of both phones after fusion, by set of trials and chain."""
    rows = []
    for words, table in result("robust_dr_figure4")["sets"].items():
        for chain, of in table.items():
            cells = (
                f"{one['before_m']:.2f} → {one['after_m']:.2f}; {one['greatest_reduction']:.1f} %; "
                f"{one['both_better']}"
                for one in of["fusions"].values()
            )
            trials = next(iter(of["fusions"].values()))["trials"]
            rows.append((f"{chain}, {trials} {words}", *cells))
            names = tuple(of["fusions"])
    return markdown_table(("chain", *(f"`{name}`" for name in names)), rows)


def beside(paper: float | None, ours: float) -> str:
    """Format the number of the paper / ours."""
    return f"{'–' if paper is None else f'{paper:.2f}'} / {ours:.2f}"


if __name__ == "__main__":
    main()
