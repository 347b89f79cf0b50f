"""The report and the result files of one walk.

* `result_files`: writes track, steps, summary and report into a folder.
* `summary`: the numbers of a walk as a JSON document. `mode_statistics`, `descriptions`, `places`: parts of it.
* `earth_placement`, `track_formats`: the place of the track on the Earth, and its files for other programs.
* `page`: the HTML report. `panels`: its still plots with titles, legends and captions.
* `explorer_data`: what its scripts draw. `fix_residuals`: known positions beside the track.
* `map_extras`: further parts of the map.
"""
