"""From a recording to a map

This tutorial starts with the recording of a phone and ends with a track on a map. The recording is simulated,
so that the true path is known and every reader gets the same numbers. At the place that is marked below, read
a recording of your own instead.
"""

# %%
# ## A recording
#
# The simulator walks around an office building and computes what the phone in the hand records. The plain CSV
# format is one of the formats that `pdr_est.read` recognises.

import numpy as np

import pdr_est
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.simulate import preset, simulate_walk

walk = simulate_walk(preset("office_loop"))
write_plain_csv(walk.recording, "walk.csv")

# %%
# **From here on, replace the file name by that of your own recording.** The reader determines units and signs
# from the header or from the values, and states how.

recording = pdr_est.read("walk.csv")
print(recording)
for decision in recording.devices[0].decisions:
    print("-", decision)

# %%
# ## The steps
#
# `analyse` runs the front end on every device: attitude, carrying mode, steps, step length, heading.

(phone,) = pdr_est.analyse(recording)
lengths_m = np.array([step.length_m for step in phone.steps])
print(f"{len(phone.steps)} steps; the simulated walker made {walk.step_count}")
print(f"mean length {lengths_m.mean():.2f} m, {lengths_m.sum():.0f} m in all")
print("carrying modes:", sorted({step.mode.name for step in phone.steps}))

# %%
# The vertical acceleration without gravity, with a dot at each detected step:

from matplotlib import pyplot as plt

block = phone.level[0]
at_s = [step.time_s for step in phone.steps]
at_steps = np.interp(at_s, block.time_s, block.vertical_mps2)

figure, axes = plt.subplots(figsize=(8, 2.6), layout="constrained")
axes.plot(block.time_s, block.vertical_mps2, color="#69727f", linewidth=0.9)
axes.plot(at_s, at_steps, "o", markersize=4, color="#7446a8")
axes.set(xlim=(20, 30), xlabel="time (s)", ylabel="vertical (m/s²)")

# %%
# ## A track without any known position
#
# Inertial sensors know neither where the walk began nor in which direction. Without a start and without
# fixes, the track is in a frame of its own: it begins at the origin, and the first step leads along x.
# Position and heading are exact there by definition, and the ellipses, which contain the walker with 95 %
# probability, grow along the walk.

track = pdr_est.smooth(recording)
print(track)
axes = track.plot()

# %%
# ## Known positions
#
# A `PositionFix` says where the walker was at one time, with a covariance. The GPS positions of a recording
# are `recording.fixes`. Here two points are given by hand, with a standard deviation of half a metre, at one
# third and two thirds of the walk; for a real walk you would read them from a floor plan.

from pdr_est.config import StartParams

fixes = [
    pdr_est.PositionFix(41.7, np.array([24.1, 26.9]), 0.5**2 * np.eye(2)),
    pdr_est.PositionFix(83.5, np.array([-21.3, 28.1]), 0.5**2 * np.eye(2)),
]
config = pdr_est.Config(start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0))
on_map = pdr_est.smooth(recording, config, fixes)
axes = on_map.plot(fixes=fixes, truth_m=walk.truth_position_m)

# %%
# The smoother has also estimated the step length of this walker from the fixes:

scale, sigma = on_map.length_scale, on_map.sigma_length_scale
print(f"the steps are {scale:.3f} ± {sigma:.3f} times as long as the model's")

# %%
# ## Is the covariance right?
#
# The true path is known here, so that the error can be compared with the covariance of the track.

truth_m = np.column_stack([np.interp(on_map.time_s, walk.truth_time_s, axis_m) for axis_m in walk.truth_position_m.T])
error_m = on_map.position_m - truth_m
squared = np.einsum("ni,nij,nj->n", error_m, np.linalg.inv(on_map.covariance_m2), error_m)
print(f"root mean square error {np.sqrt((error_m**2).sum(axis=1).mean()):.2f} m")
print(f"{(squared < 5.99).mean():.0%} of the positions are within their 95 % ellipse")

# %%
# Positions of one walk err together, so that one walk has nearly all or hardly any of them within. Over many
# walks the fraction is right: see *What the covariance means*.
#
# ## The map
#
# With the latitude and longitude of the origin, the track becomes a line on a map. QGIS, geojson.io and most
# web maps open GeoJSON.

import json
from pathlib import Path

from pdr_est.io.writers.geojson import write_geojson
from pdr_est.types.recording import GeoOrigin

zurich = GeoOrigin(latitude_deg=47.3769, longitude_deg=8.5417)
write_geojson(on_map, "track.geojson", zurich, fixes=fixes)
line = json.loads(Path("track.geojson").read_text())["features"][0]["geometry"]
print(line["type"], "with", len(line["coordinates"]), "points, from", line["coordinates"][0])

# %%
# The table `track.csv` holds the same poses in metres, with their covariance. `Track.from_csv` reads it back.

on_map.to_csv("track.csv")
frame = pdr_est.Track.from_csv("track.csv").to_polars()
print(frame.select("time_s", "x_m", "y_m", "cov_xx_m2", "mode").head(4))
