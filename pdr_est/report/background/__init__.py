"""Backgrounds of the map of a report: a picture, lines of a plan, or map tiles.

* `reading`: recognises and reads what the user names.
* `kinds`: one record for each kind, and how it is placed in the frame of the track.
* `placement`: where that frame lies on the map and on the Earth.
"""
