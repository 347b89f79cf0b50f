"""Make the tables of experiments/README.md that compare with the papers, from the recorded results.

    python experiments/paper_tables.py

Reads experiments/results/*.json, which the scripts of the papers write, and writes the tables between their marks.
Nothing is computed anew.
"""

import json
from collections.abc import Callable, Mapping
from typing import Any

from recorded import RESULTS, command_line, markdown_table, write_table

_NUMBERS_FROM = 36  # columns of the names in results/mmpdr_table10.txt
MODES = ("HOLDING", "SWING", "POCKET")
# Of the paper, which its tables VIII and IX have of each walk; ours are in the results.
PAPER_HEADINGS = {
    "indoor HOLDING": (14.23, 1.96, 0.75, 100.04),
    "indoor SWING": (14.8, 4.63, 1.33, 98.37),
    "indoor POCKET": (10.58, 3.16, 0.71, 96.86),
    "indoor, all modes": (13.52, 3.41, 1.01, 98.01),
    "indoor HOLDING, POCKET": (6.43, 0.94, 0.84, 96.89),
}

# Of each table and figure: what it is, the walks of ours, the command, the paper's numbers / ours, why they differ.
# ruff: noqa: E501
OVERVIEW = """\
| paper | ours | command | the paper's / ours | why they differ |
| --- | --- | --- | --- | --- |
| MMPDR Table VI, modes | simulated | `python experiments/mmpdr_table6.py` | right in HOLDING 96.88 / {t6[HOLDING]:.2f} %, SWING 89.48 / {t6[SWING]:.2f} %, POCKET 92.86 / {t6[POCKET]:.2f} % (`mmpdr`) | [below](#mmpdr-table-vi) |
| MMPDR Table VII, step lengths | simulated | `python experiments/mmpdr_table7.py` | STD of eq. 9: 2.30 / {t7:.2f} m | [below](#mmpdr-table-vii) |
| MMPDR Table VIII, one mode | simulated | `python experiments/mmpdr_tables8_9.py`, `python experiments/mmpdr_table10.py` | HOLDING, by the paper's method: steps 100.00 / {steps[indoor HOLDING][mmpdr][ratio]:.2f} %, heading 1.96 / {t10[indoor HOLDING][paper][heading_median_deg]:.2f}°, position 0.75 / {t10[indoor HOLDING][paper][position_m]:.2f} m, distance 100.04 / {t10[indoor HOLDING][paper][travelled_percent]:.2f} % | [steps](#mmpdr-tables-viii-and-ix), [headings](#mmpdr-tables-viii-to-x-headings-and-positions) |
| MMPDR Table IX, changing modes | simulated | the same | steps 97.80 / {steps[indoor, all modes][mmpdr][ratio]:.2f} %, heading 3.41 / {t10[indoor, all modes][paper][heading_median_deg]:.2f}°, position 1.01 / {t10[indoor, all modes][paper][position_m]:.2f} m, and the offsets | the same |
| MMPDR Table X, summary | simulated | `python experiments/mmpdr_table10.py` | median heading error and others: [below](#mmpdr-tables-viii-to-x-headings-and-positions) | the same; the other works in the table are theirs |
| MMPDR Figs 10 and 13, paths | simulated | `python experiments/mmpdr_figures.py` | pictures / [Fig. 10](results/mmpdr_figure10.png), [Fig. 13](results/mmpdr_figure13.png) | [below](#mmpdr-figures-10-11-and-13) |
| MMPDR Fig. 11, position error along the path | simulated | the same | at most 0.6 m on the first 45 m / {f11[paper][mean][straight_most_m]:.2f} m, {f11[default][mean][straight_most_m]:.2f} m (default); at most 2.5 m / {f11[paper][mean][most_m]:.2f} m, {f11[default][mean][most_m]:.2f} m; [curve](results/mmpdr_figure11.png) | [below](#mmpdr-figures-10-11-and-13) |
| MMPDR Fig. 12 | – | – | photographs of pockets | nothing to compute |
| MMPDR Fig. 14, time of an iteration | simulated | `python experiments/front_end_cost.py` | 14.7 ms at most on the phone / median 0.004 ms, 99th percentile 0.258 ms, one sample a push | another machine and no drawing; ours are modes and steps only |
| MMPDR Fig. 15, park | simulated | `python experiments/mmpdr_tables8_9.py`, `python experiments/mmpdr_table10.py` | steps 97.60 / {steps[park, all modes][mmpdr][ratio]:.2f} %; no error of the path in the paper / {t10[park, all modes][paper][heading_median_deg]:.2f}°, {t10[park, all modes][paper][position_m]:.2f} m | below, last rows |
| UPTIME Table II, step length by gait | MotionSense, SisFall | `python experiments/uptime_table2.py --data DIR` | 0.74 / {walking_m:.2f} m walking in the pocket (`auto`) | [below](#uptime-table-ii): no length is known there |
| UPTIME Table III, step detectors | Oxford steps | `python experiments/uptime_table3.py --data DIR` | `uptime-fsm` 5.72 / {fsm:.2f} % in hand and pocket | [below](#uptime-table-iii): other phones and people, fixed thresholds |
| UPTIME Table IV, gaits | MotionSense; SisFall | `python experiments/uptime_table4.py --data DIR` | walking against faster 98.13 / {pocket[walking_accuracy]:.2f}; {belt[walking_accuracy]:.2f} %, three gaits 97.74 / –; {belt[gait_accuracy]:.2f} % (random split) | [below](#uptime-table-iv): SisFall's slow and quick jogging overlap |
| UPTIME Fig. 6, step detectors by step size | Oxford steps, simulated | `python experiments/uptime_figure6.py --data DIR` | bars without numbers / [bars](results/uptime_figure6.png) | [below](#uptime-figure-6) |
| UPTIME Fig. 7, error along a trip | simulated; known-distance, stride-length | `python experiments/uptime_figure7.py --data DIR` | a curve without numbers / at the end of the trip in three gaits {trip[gait-table][final_percent]:+.1f} % by gait, {trip[static][final_percent]:+.1f} % fixed | [below](#uptime-figure-7) |
| UPTIME Figs 8 and 9, traces | simulated; known-distance, phyphox, phone-gps | `python experiments/uptime_figures8_9.py --data DIR` | outdoors 6.9 / {outdoors:.1f} % (phone-gps, held), indoors 5.9 / {indoors:.1f} % (hallway) | [below](#uptime-figures-8-and-9): one length for everybody |
| PSP Table I, return errors | simulated | `python experiments/psp_table1.py` | `psp`, mean: trajectory I 0.96 / {psp[I][percent]:.2f} %, II 1.33 / {psp[II][percent]:.2f} %; median of II {psp[II][median_percent]:.2f} % | [below](#psp-table-i) |
| PSP Fig. 3, paths | simulated | `python experiments/psp_figure3.py` | pictures / [Fig. 3](results/psp_figure3.png) | [below](#psp-figure-3): where its circle lies is not in our text |
| Robust DR Fig. 4, ten trials | simulated | `python experiments/robust_dr_figure4.py` | a phone's error cut by `map-closed-form` by up to 73.7 / {fusions[map-closed-form][greatest_reduction]:.1f} %, {opposed[map-closed-form][greatest_reduction]:.1f} % with opposed compasses; both phones better in 5 / {fusions[map-closed-form][both_better]}, {opposed[map-closed-form][both_better]} of 10 trials | [below](#robust-dr-figures-4-to-8) |
| Robust DR Figs 5 to 8, errors and paths of trials 6 and 7 | simulated | the same | curves without numbers / [curves](results/robust_dr_figure4.png) of the trials with the greatest and the median reduction | [below](#robust-dr-figures-4-to-8): other trials, our path |"""


def main() -> None:
    """Write the tables into the page."""
    command_line(__doc__)
    for name, table in paper_tables().items():
        write_table(f"<!-- {name} -->", table)


def paper_tables() -> dict[str, str]:
    """Make all tables: name of the mark -> Markdown."""
    tables: Mapping[str, Callable[[], str]] = {
        "overview": overview,
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


def overview() -> str:
    """Make the table with a row for every table and figure of the four papers."""
    gaits = {
        one["where"]: one["percent"]
        for one in result("uptime_table4")
        if (one["who"], one["split"]) == ("published", "random steps")
    }
    trips = result("uptime_figures8_9")["error_percent"]
    outdoors, indoors = (
        sum(abs(error) for error in trips[group]["uptime"]) / len(trips[group]["uptime"])
        for group in ("phone-gps, held", "phyphox hallway loop, in hand")
    )
    psp = {one["trajectory"]: one for one in result("psp_table1")["blocks"] if one["set_up"] == "paper"}
    robust_dr = result("robust_dr_figure4")["sets"]
    facts = {
        "t6": {mode: result("mmpdr_table6")["methods"]["mmpdr"]["changes"][mode][mode] for mode in MODES},
        "t7": result("mmpdr_table7")["mmpdr"]["std"],
        "steps": result("mmpdr_tables8_9")["rows"],
        "t10": result("mmpdr_table10")["rows"],
        "walking_m": result("uptime_table2")[0]["models"]["auto"]["length_m"][0],
        "fsm": result("uptime_table3")["hand and pocket"]["measured_percent"]["uptime-fsm"],
        "pocket": gaits["motionsense"],
        "belt": gaits["sisfall"],
        "trip": result("uptime_figure7")["gaits"]["scaled"],
        "outdoors": outdoors,
        "indoors": indoors,
        "f11": result("mmpdr_figures")["chains"],
        "fusions": robust_dr["trials"]["pointing"]["fusions"],
        "opposed": robust_dr["opposed compasses"]["pointing"]["fusions"],
        "psp": {name: one["methods"]["psp"] for name, one in psp.items()},
    }
    return OVERVIEW.format(**facts)


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
    """Tabulate both rows of Table X, whose numbers are only in the text of the results."""
    text = (RESULTS / "mmpdr_table10.txt").read_text(encoding="utf-8")
    _, *lines = text[text.index("Table X ") :].split("\n\n")[0].splitlines()
    rows, walks = [], ""
    for line in lines:
        words, numbers = line[:_NUMBERS_FROM].split("="), line[_NUMBERS_FROM:].split()
        walks = words[0].replace("paper", "").strip() or walks
        who = f"chain `{words[1].strip()}`" if len(words) > 1 else "paper"
        rows.append((f"{walks}, {who}", *numbers))
    titles = (
        "walks",
        "median, deg",
        "mean",
        "95th percentile",
        "distance, %",
        "position, %",
        "error over sigma, rms",
    )
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
                f"{one['before_m']:.2f} → {one['after_m']:.2f}; {one['greatest_reduction']:.1f} %; {one['both_better']}"
                for one in of["fusions"].values()
            )
            trials = next(iter(of["fusions"].values()))["trials"]
            rows.append((f"{chain}, {trials} {words}", *cells))
            names = tuple(of["fusions"])
    return markdown_table(("chain", *(f"`{name}`" for name in names)), rows)


def beside(paper: float | None, ours: float) -> str:
    """Format the number of the paper / ours."""
    return f"{'–' if paper is None else f'{paper:.2f}'} / {ours:.2f}"


def result(stem: str) -> Any:
    """Read a recorded document."""
    return json.loads((RESULTS / f"{stem}.json").read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
