"""Input and output: read recordings of any known format, and write the files of a result.

===========  ===========================================================================================
subpackage   content
===========  ===========================================================================================
formats      recorder apps and data sets: one module or folder a format, and the registry that finds it
floor_plans  plans of floors: GeoJSON, the competition's maps, pictures
side_tables  tables beside a recording: position fixes, clock messages, known distances, ground truth
text         from paths to bytes and from text tables to arrays
conversion   units, signs, axes, and latitude and longitude in the project's conventions
writers      tracks, steps and tables, written completely or not at all
===========  ===========================================================================================

`pdr_est.io.read` reads a recording; conventions of its units, axes and signs stand in
`pdr_est.types.recording.DeviceRecording`.
"""

from pdr_est.io.formats.registry import read

__all__ = ["read"]
