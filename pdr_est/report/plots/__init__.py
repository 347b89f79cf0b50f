"""Figures of a walk, drawn with matplotlib and embedded in the page as SVG.

* `track`, `track_line`: the track on the map, with uncertainty, fixes and truth; its line coloured by carrying modes.
* `acceleration`: vertical acceleration with the detected steps. `gait`: heading, step length and cadence over time.
* `time_axis`: the time axis of the plots over time. `mode_style`: colours, line styles and strips of carrying modes.
* `figure`: look of all figures and conversion to SVG. `legend`: entries of the legends.
"""
