"""Rows of experiments/README.md: every table and figure of the four papers beside ours.

Each text is a table with a row for each table or figure: what it is, the paper's numbers, ours, why they differ, and the
command. Numbers of ours stand in braces and are filled in by `overview_tables` from the recorded results.
"""
# ruff: noqa: E501

import json
import re
from collections.abc import Mapping
from typing import Any

from recorded import RESULTS

MODES = ("HOLDING", "SWING", "POCKET")

MMPDR = """\
| MMPDR | the paper's | ours | why they differ | command |
| --- | --- | --- | --- | --- |
| Table VI, modes recognised, % in HOLDING / SWING / POCKET | 96.88 / 89.48 / 92.86 | {t6[HOLDING]:.2f} / {t6[SWING]:.2f} / {t6[POCKET]:.2f} | Shown: one person in three carries the phone upright in the pocket, which meets the paper's condition for HOLDING; [what follows a mistake](paper-details.md#mmpdr-table-vi) | `python experiments/mmpdr_table6.py` |
| Table VII, STD of eqs. 2 / 3 / 4 / 9, m | 3.58 / 2.69 / 2.73 / 2.30 | {t7[static][std]:.2f} / {t7[weinberg][std]:.2f} / {t7[scarlett][std]:.2f} / {t7[mmpdr][std]:.2f} | Not shown. Likely: simulated steps follow eq. 9 but for habits of 5 % | `python experiments/mmpdr_table7.py` |
| Table VIII, HOLDING: steps, %; heading, °; position, m; distance, % | 100.00; 1.96; 0.75; 100.04 | {held} | Shown: a swing of the trunk at the halt counts as a step (without it {causes[indoor HOLDING][to the end]:.2f} % of the steps); the length of a person is off eq. 9 (with true lengths the position is {causes[indoor HOLDING][lengths]:.1f} %, as it is {causes[indoor HOLDING][position]:.1f} %) | `python experiments/mmpdr_tables8_9.py`, `python experiments/mmpdr_table10.py`, `python experiments/mmpdr_causes.py` |
| Table VIII, SWING | 99.22; 4.63; 1.33; 98.37 | {swung} | Shown: the same (without the swing of the arm at the halt {causes[indoor SWING][to the end]:.2f} % of the steps) | the same |
| Table VIII, POCKET | 98.44; 3.16; 0.71; 96.86 | {pocketed} | Shown: of some legs, as of both people of OxIOD, the detector counts half of the steps; one of twelve walkers decides | the same |
| Table IX, all modes | 97.80; 3.41; 1.01; 98.01 | {all_modes} | Shown: modes that are not found (where all are: {causes[indoor, all modes; recognised][steps]:.2f} % of the steps, 95th percentile {causes[indoor, all modes; recognised][95 %, deg]:.0f}° instead of {causes[indoor, all modes][95 %, deg]:.0f}°), and eq. 9 with a step too many (true lengths: position {causes[indoor, all modes][lengths]:.1f} instead of {causes[indoor, all modes][position]:.1f} %) | the same |
| Table IX, HOLDING and POCKET | 97.66; 0.94; 0.84; 96.89 | {two_modes} | Shown: the same (all modes found: {causes[indoor HOLDING, POCKET; recognised][steps]:.2f} % of the steps, position {causes[indoor HOLDING, POCKET; recognised][position]:.1f} %) | the same |
| Table X, single mode: heading, median / 95th percentile, °; distance / position, % | 2.84 / 10.94; 98.43 / 99.03 | {single} | as in Table VIII | the same |
| Table X, multi-mode | 2.88 / 12.06; 97.83 / 98.91 | {multi} | as in Table IX | the same |
| Fig. 10 and 13, paths | pictures | [Fig. 10](results/mmpdr_figure10.png), [Fig. 13](results/mmpdr_figure13.png) | – | `python experiments/mmpdr_figures.py` |
| Fig. 11, position error along the path: at most on the first 45 m / on all, m | 0.6 / 2.5 | {f11[paper][mean][straight_most_m]:.2f} / {f11[paper][mean][most_m]:.2f} ([curve](results/mmpdr_figure11.png)) | Shown by the curve: the error grows from the first metre, as a wrong length does on a straight line | the same |
| Fig. 14, time of an iteration, ms | 14.7 at most | {cost_median:.3f} in the median, {cost_99:.3f} at the 99th percentile | another machine and no drawing; modes and steps only | `python experiments/front_end_cost.py` |
| Fig. 15, park: steps, %; heading, °; position, m | 97.60; –; – | {park} | Shown: 95th percentile {causes[park, all modes][95 %, deg]:.0f}° because of modes that are not found ({causes[park, all modes; recognised][95 %, deg]:.0f}° where they are) | as Table IX |
| Figs 6 to 8, 12, Table XI | signals and pockets; other works | – | nothing to compute | – |"""

UPTIME = """\
| UPTIME | the paper's | ours | why they differ | command |
| --- | --- | --- | --- | --- |
| Table II, step when walking / jogging / running, m | 0.74 / 1.01 / 1.70 | MotionSense (pocket) {lengths[0]:.2f} / {lengths[1]:.2f} / –, SisFall (belt) {lengths[3]:.2f} / {lengths[4]:.2f} / {lengths[5]:.2f} (`auto`) | Not shown, as no length is known in these sets. Likely: the paper's runner is a fast one | `python experiments/uptime_table2.py --data DIR` |
| Table III, errors of the step machine in the hand / pocket, % | 2.66 / 9.29 | {fsm[in hand]:.2f} / {fsm[in pocket]:.2f} | Likely: fixed thresholds on phones and people for which they were not found; jolts of a back pocket are counted as steps | `python experiments/uptime_table3.py --data DIR` |
| Table III, local variance, hand and pocket, % | 35.08 | {t3[local-variance, untuned]:.2f} with thresholds for the foot, {t3[local-variance]:.2f} tuned | Likely: thresholds; the paper gives none | the same |
| Table III, zero crossing, % | 31.98 | {t3[zero-crossing, untuned]:.2f} untuned, {t3[zero-crossing]:.2f} tuned | Likely: our zero is a running mean | the same |
| Table IV, walking against faster, % | 98.13 | MotionSense {pocket[walking_accuracy]:.2f}, SisFall {belt[walking_accuracy]:.2f}; people left out {pocket_out[walking_accuracy]:.2f}, {belt_out[walking_accuracy]:.2f} | Likely: the paper's training and test were parted by steps, as the first two of ours; it does not say | `python experiments/uptime_table4.py --data DIR` |
| Table IV, three gaits, % | 97.74 | SisFall {belt[gait_accuracy]:.2f}; people left out {belt_out[gait_accuracy]:.2f} | Likely: slow and quick jogging of SisFall overlap ([each is taken for the other](paper-details.md#uptime-table-iv)), unlike the paper's jogging and running | the same |
| Fig. 6, step detectors by step size | bars without numbers | [bars](results/uptime_figure6.png) | – | `python experiments/uptime_figure6.py --data DIR` |
| Fig. 7, error at the end of a trip in three gaits, % | a curve without numbers | {trip[gait-table][final_percent]:+.1f} by gait, {trip[static][final_percent]:+.1f} with a fixed length ([curve](results/uptime_figure7.png)) | the paper's order; a fixed length loses its metres where somebody jogs or runs | `python experiments/uptime_figure7.py --data DIR` |
| Fig. 8, distance outdoors, % | 6.9 | {outdoors:.1f} (phone-gps, held) | Likely: Table II is one walker's. Shown: [our steps and gaits](paper-details.md#uptime-figures-8-and-9) in its place change little | `python experiments/uptime_figures8_9.py --data DIR` |
| Fig. 9, distance indoors, % | 5.9 | {indoors:.1f} (hallway) | – | the same |"""

PSP = """\
| PSP, % of the way, mean (median) | the paper's | ours | why they differ | command |
| --- | --- | --- | --- | --- |
| Table I, I, bare gyroscope | 10.07 | {psp[I][paper][gyro]} | our legs and gyroscope were fitted to this line, on other seeds | `python experiments/psp_table1.py` |
| Table I, I, HDE | 1.05 | {psp[I][paper][hde]} | – | the same |
| Table I, I, PSP | 0.96 | {psp[I][paper][psp]} | – | the same |
| Table I, I, magnetometer | 9.51 | {psp[I][paper][magnetometer]} | our iron | the same |
| Table I, II, bare gyroscope | 7.62 | {psp[II][paper][gyro]} | fitted as on I | the same |
| Table I, II, HDE | 6.87 | {psp[II][paper][hde]} | not fitted; few tests come out of the circle 90° wrong, or do not | the same |
| Table I, II, PSP | 1.33 | {psp[II][paper][psp]} | Shown: the gyroscope's drift (with a quarter of it {psp[II][small drift][psp]}) | the same |
| PSP below HDE on II | 81 % | {below:.0f} % | as above | the same |
| Table I, II, magnetometer | 8.90 | {psp[II][paper][magnetometer]} | our iron | the same |
| the method with legs that circle, I / II | not in the paper | {psp[I][circling legs][psp]} / {psp[II][circling legs][psp]} | Shown: legs that circle turn the phone about its long axis on straight paths, too | the same |
| Fig. 3, paths | pictures | [Fig. 3](results/psp_figure3.png) | where its circle lies is not in our text | `python experiments/psp_figure3.py` |"""

ROBUST_DR = """\
| Robust DR | the paper's | ours | why they differ | command |
| --- | --- | --- | --- | --- |
| Fig. 4, greatest cut of a phone's mean error, % | 73.7 | {fusions[published][trials]:.1f} as published; {fusions[pointing][trials]:.1f} with headings of a compass; {fusions[pointing][opposed compasses]:.1f} with opposed compasses | Shown: headings by section III-E tell next to nothing here, and iron of the building makes both compasses err alike | `python experiments/robust_dr_figure4.py` |
| Fig. 4, trials of 10 in which both phones gain | 5 | {both[published][trials]}; {both[pointing][trials]}; {both[pointing][opposed compasses]} | the same | the same |
| Figs 5 to 8, errors and paths of two trials | curves without numbers | [curves](results/robust_dr_figure4.png) | other trials, our path and iron | the same |"""


def overview_tables() -> dict[str, str]:
    """Make the table of each paper: name of the mark -> Markdown."""
    return {
        "overview mmpdr": MMPDR.format_map(mmpdr_facts()),
        "overview uptime": UPTIME.format_map(uptime_facts()),
        "overview psp": PSP.format_map(psp_facts()),
        "overview robust dr": ROBUST_DR.format_map(robust_dr_facts()),
    }


def mmpdr_facts() -> dict[str, Any]:
    """Collect ours of MMPDR."""
    steps, headings = result("mmpdr_tables8_9")["rows"], result("mmpdr_table10")["rows"]

    def of_walks(words: str) -> str:
        one = headings[words]["paper"]
        found = f"{one['heading_median_deg']:.2f}; {one['position_m']:.2f}; {one['travelled_percent']:.2f}"
        return f"{steps[words]['mmpdr']['ratio']:.2f}; {found}"

    summary = {words: f"{row[0]} / {row[2]}; {row[3]} / {row[4]}" for words, row in table_10_rows().items()}
    push = re.search(r"(\d+) us a push in the median, (\d+) us", text("front_end_cost"))
    if push is None:
        raise ValueError(
            "results/front_end_cost.txt has no time of single samples: run experiments/front_end_cost.py"
        )
    return {
        "t6": {mode: result("mmpdr_table6")["methods"]["mmpdr"]["changes"][mode][mode] for mode in MODES},
        "t7": result("mmpdr_table7"),
        "held": of_walks("indoor HOLDING"),
        "swung": of_walks("indoor SWING"),
        "pocketed": of_walks("indoor POCKET"),
        "all_modes": of_walks("indoor, all modes"),
        "two_modes": of_walks("indoor HOLDING, POCKET"),
        "park": of_walks("park, all modes").rpartition(";")[0],
        "causes": result("mmpdr_causes")["rows"],
        "single": summary["single mode, chain `paper`"],
        "multi": summary["multi-mode, chain `paper`"],
        "f11": result("mmpdr_figures")["chains"],
        "cost_median": 1e-3 * int(push[1]),
        "cost_99": 1e-3 * int(push[2]),
    }


_NUMBERS_FROM = 36  # columns of the names in results/mmpdr_table10.txt


def table_10_rows() -> dict[str, list[str]]:
    """Read the rows of Table X, whose numbers are only in the text of the results: walks and chain -> cells."""
    recorded = text("mmpdr_table10")
    _, *lines = recorded[recorded.index("Table X ") :].split("\n\n")[0].splitlines()
    rows, walks = {}, ""
    for line in lines:
        words = line[:_NUMBERS_FROM].split("=")
        walks = words[0].replace("paper", "").strip() or walks
        who = f"chain `{words[1].strip()}`" if len(words) > 1 else "paper"
        rows[f"{walks}, {who}"] = line[_NUMBERS_FROM:].split()
    return rows


def uptime_facts() -> dict[str, Any]:
    """Collect ours of UPTIME."""
    gaits = {
        (one["split"], one["where"]): one["percent"] for one in result("uptime_table4") if one["who"] == "published"
    }
    trips = result("uptime_figures8_9")["error_percent"]
    outdoors, indoors = (
        sum(abs(error) for error in trips[group]["uptime"]) / len(trips[group]["uptime"])
        for group in ("phone-gps, held", "phyphox hallway loop, in hand")
    )
    detectors = result("uptime_table3")
    return {
        "lengths": [one["models"]["auto"]["length_m"][0] for one in result("uptime_table2")],
        "fsm": {place: one["measured_percent"]["uptime-fsm"] for place, one in detectors.items()},
        "t3": detectors["hand and pocket"]["measured_percent"],
        "pocket": gaits["random steps", "motionsense"],
        "belt": gaits["random steps", "sisfall"],
        "pocket_out": gaits["people left out", "motionsense"],
        "belt_out": gaits["people left out", "sisfall"],
        "trip": result("uptime_figure7")["gaits"]["scaled"],
        "outdoors": outdoors,
        "indoors": indoors,
    }


def psp_facts() -> dict[str, Any]:
    """Collect ours of PSP: mean and median by trajectory, set-up and method."""
    cells: dict[str, dict[str, dict[str, str]]] = {}
    means: dict[str, Mapping[str, Any]] = {}
    for block in result("psp_table1")["blocks"]:
        of = {name: f"{one['percent']:.2f} ({one['median_percent']:.2f})" for name, one in block["methods"].items()}
        cells.setdefault(block["trajectory"], {})[block["set_up"]] = of
        if (block["trajectory"], block["set_up"]) == ("II", "paper"):
            means = block["methods"]
    return {"psp": cells, "below": 100.0 * (1.0 - means["psp"]["percent"] / means["hde"]["percent"])}


def robust_dr_facts() -> dict[str, Any]:
    """Collect ours of Robust DR, fused by the closed form: by chain and set of trials."""
    cuts: dict[str, dict[str, float]] = {}
    both: dict[str, dict[str, int]] = {}
    for words, table in result("robust_dr_figure4")["sets"].items():
        for chain, of in table.items():
            fused = of["fusions"]["map-closed-form"]
            cuts.setdefault(chain, {})[words] = fused["greatest_reduction"]
            both.setdefault(chain, {})[words] = fused["both_better"]
    return {"fusions": cuts, "both": both}


def result(stem: str) -> Any:
    """Read a recorded document."""
    return json.loads((RESULTS / f"{stem}.json").read_text(encoding="utf-8"))


def text(stem: str) -> str:
    """Read a recorded text."""
    return (RESULTS / f"{stem}.txt").read_text(encoding="utf-8")
