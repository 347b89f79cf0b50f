"""Figures 10, 11 and 13 of MMPDR (Tian et al. 2016) on simulated walks: paths by carrying mode, errors along them.

    python experiments/mmpdr_figures.py [--seeds 0 1 2 3 4 5]

Figures 10 and 13 are paths of one walker in each single mode, and of five walkers in all modes, the last of them also
in two, by the paper's chain (`paper` of mmpdr_table10.py) and by the default, from the known start; each part of a
path has the colour of the mode that was recognised, as in the paper, on the true path. Figure 11 is the position
error at every metre of the path in each single mode, mean over the walkers, and the mean of the three modes.

Writes experiments/results/mmpdr_figure10.png, mmpdr_figure11.png, mmpdr_figure13.png, mmpdr_figures.json and .txt.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mmpdr_table10 import CHAINS, errors_of, reckoned
from mmpdr_walks import HOLDING, POCKET, ROWS, SWING, WALKERS
from recorded import RESULTS, command_line, write

from pdr_est.frames import Array
from pdr_est.simulate import SimulatedWalk
from pdr_est.types.track import Track

SHOWN = ("paper", "default")
COLOURS = {HOLDING: "tab:red", SWING: "tab:blue", POCKET: "tab:green"}  # the paper's
OTHER_MODE = "0.5"
SINGLE, ALL_MODES, TWO_MODES = ROWS[:3], ROWS[3], ROWS[4]
STRAIGHT_M = 45  # the first leg of the path
PAPER_STRAIGHT_M, PAPER_MOST_M = 0.6, 2.5  # of figure 11, which is a curve without other numbers


@dataclass(frozen=True)
class Panel:
    """Path of figure 10 or 13: its title, the walk, and the track of each chain."""

    title: str
    walk: SimulatedWalk
    tracks: Mapping[str, Track]


def main() -> None:
    """Simulate, draw and write."""
    seeds = command_line(__doc__, {"--seeds": list(range(WALKERS))}).seeds
    figures = {
        "mmpdr_figure10": paths_figure(single_mode_panels(seeds[0])),
        "mmpdr_figure13": paths_figure(changing_panels(seeds[:5])),
    }
    curves = mean_errors(seeds)
    figures["mmpdr_figure11"] = errors_figure(curves)
    for name, figure in figures.items():
        figure.savefig(RESULTS / f"{name}.png", dpi=80, metadata={"Software": None})
    write("mmpdr_figures", as_text(curves, seeds), as_document(curves, seeds))


def single_mode_panels(seed: int) -> list[Panel]:
    """Simulate figure 10: one walker in each mode."""
    walks = [(row.words, row.walks([seed])[0]) for row in SINGLE]
    return [panel(f"({letter}) {words}", walk) for letter, (words, walk) in zip("abc", walks, strict=True)]


def changing_panels(seeds: Sequence[int]) -> list[Panel]:
    """Simulate figure 13: some walkers in all modes, and the last of them in two."""
    walks = [(f"walker {number}, all modes", walk) for number, walk in enumerate(ALL_MODES.walks(seeds), 1)]
    walks += [(f"walker {len(seeds)}, two modes", TWO_MODES.walks(seeds[-1:])[0])]
    return [panel(f"({'abcdef'[number]}) {words}", walk) for number, (words, walk) in enumerate(walks)]


def panel(title: str, walk: SimulatedWalk) -> Panel:
    """Estimate a walk with each chain that is shown."""
    return Panel(title, walk, {name: reckoned(walk, CHAINS[name]).track for name in SHOWN})


def mean_errors(seeds: Sequence[int]) -> dict[str, dict[str, Array]]:
    """Average the position error, m, at every metre over walkers, by chain and kind of walk; "mean" is over modes."""
    curves: dict[str, dict[str, Array]] = {name: {} for name in SHOWN}
    for row in SINGLE:
        walks = row.walks(seeds)
        for name, by_row in curves.items():
            errors = [errors_of(walk, CHAINS[name]).position_m for walk in walks]
            shortest = min(len(one) for one in errors)
            by_row[row.words] = np.mean([one[:shortest] for one in errors], axis=0)
    for by_row in curves.values():
        shortest = min(len(one) for one in by_row.values())
        by_row["mean"] = np.mean([one[:shortest] for one in by_row.values()], axis=0)
    return curves


def numbers(error_m: Array) -> dict[str, float]:
    """Return the maxima that the paper states: on the first straight segment, and in all."""
    return {
        "straight_most_m": round(float(error_m[:STRAIGHT_M].max()), 2),
        "most_m": round(float(error_m.max()), 2),
        "mean_m": round(float(error_m.mean()), 2),
    }


def as_document(curves: Mapping[str, Mapping[str, Array]], seeds: Sequence[int]) -> dict[str, object]:
    """Make the document with the numbers of the text and the curves."""
    return {
        "seeds": list(seeds),
        "paper": {"straight_most_m": PAPER_STRAIGHT_M, "most_m": PAPER_MOST_M},
        "chains": {chain: {row: numbers(one) for row, one in by.items()} for chain, by in curves.items()},
        "error_m": {
            chain: {row: np.round(one, 2).tolist() for row, one in by.items()} for chain, by in curves.items()
        },
    }


def as_text(curves: Mapping[str, Mapping[str, Array]], seeds: Sequence[int]) -> str:
    """Format a line for each chain and kind of walk."""
    lines = [
        f"MMPDR Fig. 11: position error along the path of 96 m, m, mean over {len(seeds)} walkers",
        "",
        f"{'chain':10}{'walks':18}{f'most, first {STRAIGHT_M} m':>20}{'most':>8}{'mean':>8}",
        f"{'paper, its Fig. 11':28}{f'< {PAPER_STRAIGHT_M:g}':>20}{f'< {PAPER_MOST_M:g}':>8}",
    ]
    for chain, by_row in curves.items():
        for row, error_m in by_row.items():
            lines.append(f"{chain:10}{row:18}" + "{:20.2f}{:8.2f}{:8.2f}".format(*numbers(error_m).values()))
    return "\n".join(lines) + "\n"


def paths_figure(panels: Sequence[Panel]) -> Figure:
    """Draw three panels side by side, one row for each chain, with the true path, all to one scale."""
    rows = 2 * -(-len(panels) // 3)
    figure = Figure(figsize=(15.0, 3.2 * rows + 0.5), layout="constrained")
    axes = figure.subplots(rows, 3, squeeze=False, sharex=True, sharey=True)
    for place, one in enumerate(panels):
        for lower, chain in enumerate(SHOWN):
            draw_path(axes[2 * (place // 3) + lower, place % 3], one, chain)
    names = {**{mode.name: colour for mode, colour in COLOURS.items()}, "changing or unknown": OTHER_MODE}
    lines = [Line2D([], [], color=colour, label=name) for name, colour in names.items()]
    lines.append(Line2D([], [], color="0.3", linestyle="--", label="true path"))
    figure.legend(handles=lines, loc="outside upper center", ncols=len(lines))
    return figure


def draw_path(axes: Axes, one: Panel, chain: str) -> None:
    """Draw the true path, and the track of one chain in the colours of the modes."""
    track = one.tracks[chain]
    axes.plot(*one.walk.truth_position_m.T, "--", color="0.3", linewidth=1.0)
    for mode in sorted(set(track.mode.tolist())):
        colour = COLOURS.get(mode, OTHER_MODE)
        own = np.flatnonzero(track.mode[1:] == mode) + 1  # a step belongs to the pose that it leads to
        legs = np.stack([track.position_m[own - 1], track.position_m[own], np.full((len(own), 2), np.nan)], axis=1)
        axes.plot(*legs.reshape(-1, 2).T, color=colour, linewidth=1.8)
    axes.plot(*track.position_m[0], "ko", markersize=4)
    axes.set(title=f"{one.title}, chain {chain}", xlabel="east, m", ylabel="north, m", aspect="equal")


def errors_figure(curves: Mapping[str, Mapping[str, Array]]) -> Figure:
    """Draw figure 11, with a panel for each chain."""
    figure = Figure(figsize=(12.0, 4.2), layout="constrained")
    colours = dict(zip((row.words for row in SINGLE), COLOURS.values(), strict=True))
    for axes, (chain, by_row) in zip(figure.subplots(1, len(curves)), curves.items(), strict=True):
        for row, error_m in by_row.items():
            axes.plot(np.arange(1, len(error_m) + 1), error_m, color=colours.get(row, "black"), label=row)
        axes.plot([0, STRAIGHT_M], [PAPER_STRAIGHT_M] * 2, ":", color="0.4", label="paper: its mean stays below")
        axes.axhline(PAPER_MOST_M, linestyle=":", color="0.4")
        axes.set(title=f"chain {chain}", xlabel="distance walked, m", ylabel="position error, m", xlim=(0, None))
        axes.set_ylim(bottom=0.0)
        axes.legend(fontsize=8)
    return figure


if __name__ == "__main__":
    main()
