"""Compare the default front end with the textbook chain and with RoNIN-LSTM, set by set.

    pdr-est benchmark walks --data DIR --front-end all --json walks.json    (and the same for older suites)
    python experiments/front_end_acceptance.py walks.json [ilc20.json ...]

A set is a group of a suite; of RIDI and of the small room of OxIOD, the walks with one carrying position. Prints for
each set the mean `ate_rigid_m` of both front ends, the figure of RoNIN-LSTM on the whole set (of which DIR may hold a
part), and the means of log `length_ratio`. Then: the mean over the sets of log(default / textbook), and the root mean
square of log `length_ratio` over the walks.
"""

import argparse
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from recorded import markdown_table

SMALLEST_SET = 3  # walks, below which no set is judged by itself
BY_POSITION = ("ridi", "oxiod-vicon")
# Mean ate_rigid_m, m, of RoNIN-LSTM (Herath et al. 2020) with its published weights on the whole sets.
RONIN_M = {
    "walks/humolire": 4.66,
    "walks/rfbr": 1.32,
    "walks/ridi/handheld": 1.24,
    "walks/ridi/body": 1.77,
    "walks/ridi/bag": 3.56,
    "walks/ridi/leg": 0.99,
    "walks/oxiod-vicon/handheld": 1.41,
    "walks/oxiod-vicon/pocket": 1.05,
    "walks/oxiod-vicon/bag": 10.5,
    "walks/xdr25": 8.0,
}

Row = dict[str, Any]


def main() -> None:
    """Print the tables of the documents that are named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("documents", type=Path, nargs="+")
    documents = [json.loads(path.read_text(encoding="utf-8")) for path in parser.parse_args().documents]
    rows = [row for document in documents for row in rows_of(document)]
    sets: dict[str, list[Row]] = {}
    for row in rows:
        sets.setdefault(row["set"], []).append(row)
    headings = ("set", "walks", "default", "textbook", "ratio", "RoNIN-LSTM", "length default", "length textbook")
    print(markdown_table(headings, [cells(name, of_set) for name, of_set in sorted(sets.items())]))
    print(f"\n{summary(sets, rows)}")


def rows_of(document: Row) -> Iterator[Row]:
    """Yield the rows of the walks with true positions, with the set that each belongs to."""
    for row in document["walks"]:
        if row.get("ate_rigid_m") is not None and row["track"] in ("device", "fused"):
            yield {**row, "set": set_of(document["suite"], row)}


def set_of(suite: str, row: Row) -> str:
    """Return the name of the set of a walk."""
    if suite == "walks":
        folder = row["walk"].rpartition("/")[0]
        return f"{suite}/{folder}/{row['carrying']}" if folder in BY_POSITION else f"{suite}/{folder}"
    if suite == "oxiod":
        return f"{suite}/{row['walk'].partition('/')[0]}/{row['position']}"
    return suite


def values(rows: Sequence[Row], front_end: str, metric: str) -> list[float]:
    """Return the values of a metric with one front end."""
    found = [row[metric] for row in rows if row["front-end"] == front_end]
    return [value for value in found if value is not None]


def cells(name: str, rows: Sequence[Row]) -> list[str]:
    """Make the row of a set."""
    own, textbook = (values(rows, front_end, "ate_rigid_m") for front_end in ("default", "textbook"))
    ratio = f"{np.mean(own) / np.mean(textbook):.2f}" if own and textbook else "–"
    means = [f"{np.mean(ate):.2f}" if ate else "–" for ate in (own, textbook)]
    lengths = [values(rows, front_end, "length_ratio") for front_end in ("default", "textbook")]
    ronin = f"{RONIN_M[name]:.2f}" if name in RONIN_M else "–"
    return [
        name,
        str(max(len(own), len(textbook))),
        *means,
        ratio,
        ronin,
        *(f"{np.exp(np.mean(np.log(ratios))):.3f}" if ratios else "–" for ratios in lengths),
    ]


def summary(sets: dict[str, list[Row]], rows: Sequence[Row]) -> str:
    """Say what holds over all sets and over all walks."""
    ratios = {}
    for name, of_set in sets.items():
        own, textbook = (values(of_set, front_end, "ate_rigid_m") for front_end in ("default", "textbook"))
        if name.startswith("walks/") and own and textbook:
            ratios[name] = (float(np.mean(own) / np.mean(textbook)), len(own))
    lines = []
    for least in (1, SMALLEST_SET):
        logs = [np.log(ratio) for ratio, count in ratios.values() if count >= least]
        if logs:
            words = f"over {len(logs)} sets of the suite walks with at least {least} walks"
            lines.append(f"default / textbook, geometric mean {words}: {np.exp(np.mean(logs)):.3f}")
    for front_end in ("default", "textbook"):
        logs = np.log(values(rows, front_end, "length_ratio"))
        if len(logs):
            rms, spread = np.sqrt(np.square(logs).mean()), logs.std()
            lines.append(f"log length_ratio, {front_end}, {len(logs)} walks: rms {rms:.3f}, spread {spread:.3f}")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
