"""Compare two estimators on your walks

Which estimator is better on *your* walks? An experiment answers this: it runs every variant on every walk and
compares the errors walk by walk. This tutorial compares the extended Kalman filter with the factor graph. The
walks are simulated; with recordings of your own, only the folder changes.
"""

# %%
# ## A folder of walks
#
# A phone is carried twice in the hand and twice in a pocket. Each recording is a plain CSV file whose columns
# `true_x_m,true_y_m` hold the true position at a few points. For walks of your own, put your recordings into
# a folder, with the positions that you know: *Recorder formats* says which formats bring them.

from dataclasses import replace
from pathlib import Path

from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.simulate import mmpdr_indoor, simulate_walk
from pdr_est.types.recording import Recording
from pdr_est.types.steps import CarryingMode


def with_few_true_positions(recording: Recording) -> Recording:
    """Keep every tenth true position."""
    every = recording.truth.positions
    few = replace(every, time_s=every.time_s[::10], position_m=every.position_m[::10])
    return replace(recording, truth=replace(recording.truth, positions=few))


Path("walks").mkdir()
for number, mode in enumerate([CarryingMode.HOLDING, CarryingMode.POCKET] * 2):
    recording = simulate_walk(mmpdr_indoor(mode, seed=number)).recording
    write_plain_csv(with_few_true_positions(recording), f"walks/{mode.name}-{number}.csv")
print(*sorted(path.name for path in Path("walks").iterdir()), sep="\n")

# %%
# ## The experiment
#
# One YAML file says which walks, which variants, which positions the estimators are given, and which errors
# are measured. `heldout` gives every third true position to the estimators as a fix; the others measure the
# error.

experiment = """
title: Kalman filter or factor graph?
data:
  recordings: ["*.csv"]
  folder: walks
variants:
  filter: {estimator.name: ekf}
  graph: {estimator.name: factor-graph}
fixes: {protocol: heldout}
metrics: [error_heldout_m, coverage95]
seed: 1
"""
Path("filter-or-graph.yaml").write_text(experiment)

# %%
# In a terminal you would type `pdr-est experiment filter-or-graph.yaml -o result`. The same from Python:

from pdr_est.cli import main as pdr_est

pdr_est(["experiment", "filter-or-graph.yaml", "-o", "result", "-q"], standalone_mode=False)
print(*sorted(path.name for path in Path("result").iterdir() if path.is_file()), sep="\n")

# %%
# `report.html` shows the errors in figures. `results.parquet` holds every number, one row for each walk,
# variant and metric:

import polars as pl

results = pl.read_parquet("result/results.parquet")
errors = results.filter(pl.col("metric") == "error_heldout_m")
print(errors.select("walk", "variant", "value"))

# %%
# ## Which one is better?
#
# `pdr-est compare` computes the difference of the two estimators on every walk, so that the differences
# between walks do not hide it, with a 95 % bootstrap interval over walks. If the interval contains 0, these
# walks do not decide the question.

pdr_est(["compare", "result", "--metric", "error_heldout_m"], standalone_mode=False)

# %%
# The filter uses the past only and the graph the whole walk, so that the graph is better between two fixes:

import numpy as np
from matplotlib import pyplot as plt

wide = errors.pivot("variant", index="walk", values="value").sort("walk")
places = np.arange(len(wide))

figure, axes = plt.subplots(figsize=(6, 2.8), layout="constrained")
axes.barh(places - 0.2, wide["filter"], height=0.35, color="#b08a00", label="filter")
axes.barh(places + 0.2, wide["graph"], height=0.35, color="#7446a8", label="graph")
axes.set_yticks(places, wide["walk"].to_list())
axes.set_xlabel("mean error at the held-out positions (m)")
axes.legend(frameon=False)

# %%
# ## Are the covariances right?
#
# `coverage95` is the fraction of the held-out positions within the 95 % ellipse of the track. 0.95 is right;
# with four walks it scatters.

coverage = results.filter(pl.col("metric") == "coverage95")
print(coverage.group_by("variant", maintain_order=True).agg(pl.mean("value")))
