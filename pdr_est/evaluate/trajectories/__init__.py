"""Scores of trajectories from other programs against the truth, with the metrics of pdr-est's own tracks.

==============  =======================================================================================
file            content
==============  =======================================================================================
common_clock    the times of a trajectory on the clock of the truth or of a recording
common_frame    positions of a trajectory in metres, in the frame of the truth or of a recording
person          the one person in a trajectory of several devices
foreign_track   a trajectory as a `Track`, or as true positions
on_recording    a trajectory as the truth of a recording, or as a track of it
scores          the metrics, with the alignment that each of them has
==============  =======================================================================================
"""
