"""Trajectories that other programs wrote, or that somebody surveyed: TUM, tables, GeoJSON and GPX.

==============  =======================================================================================
file            content
==============  =======================================================================================
trajectory      the record, and the checks of its positions and times
reading         recognition of the format, and reading
tum             lines `time x y z qx qy qz qw`, the format of the TUM RGB-D benchmark
geo_files       GeoJSON and GPX
==============  =======================================================================================
"""

from pdr_est.io.trajectories.reading import read_trajectory
from pdr_est.io.trajectories.trajectory import Clock, Trajectory

__all__ = ["Clock", "Trajectory", "read_trajectory"]
