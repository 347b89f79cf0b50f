"""Words that the options of the command line offer.

Each list is that of the part which it belongs to. It stands here once more because the parts need numpy and scipy,
whose loading would make every help text and every completion of a word ten times slower. A test compares the lists.
"""

from types import MappingProxyType

ESTIMATORS = ("dead-reckoning", "map-closed-form", "map-general", "ekf", "factor-graph", "fixed-lag", "particle")
DETECTORS = (
    "auto",
    "mmpdr",
    "uptime-fsm",
    "relative-threshold",
    "local-variance",
    "zero-crossing",
    "magnitude-peaks",
)
LENGTH_MODELS = (
    "auto",
    "harmonic",
    "walk-run",
    "range-power",
    "static",
    "weinberg",
    "scarlett",
    "mmpdr",
    "gait-table",
    "kim",
)
HEADING_METHODS = (
    "auto",
    "step-yaw",
    "mmpdr",
    "gyro",
    "hde",
    "psp",
    "acceleration-integration",
    "principal-axis",
    "magnetometer",
)
CLOCK_METHODS = ("walk", "messages", "given", "none")

RECORDING_FORMATS = ("csv", "parquet", "sensor-logger", "npz", "hdf5")
"""Formats that `pdr-est convert` writes."""

TRACK_FORMATS = ("tum", "geojson", "kml", "gpx", "tum-covariance", "iso21134")
"""Formats in which `pdr-est smooth` writes a track for other programs."""

SUITE_NAMES = (
    "gait",
    "ilc20",
    "ipin2023",
    "known-distance",
    "motionsense",
    "oxford-steps",
    "oxiod",
    "phone-gps",
    "speed",
    "stride-length",
    "walks",
    "weallwalk",
)
"""Suites of `pdr-est benchmark`, the measurement of speed included."""

COMPARED = MappingProxyType(
    {
        "estimator": (ESTIMATORS, "factor-graph"),
        "detector": (DETECTORS, "auto"),
        "length-model": (LENGTH_MODELS, "auto"),
        "heading": (HEADING_METHODS, "auto"),
        "front-end": (("default", "textbook"), "default"),
    }
)
"""Settings that `pdr-est benchmark` compares: values and default."""
EVERY_VALUE = "all"
"""Word for all values of such a setting."""

DEVICE_TURNS = "x90, x180, z90, … (axis and degrees from -360 to 360) or random:SEED"
"""Values of `pdr-est benchmark --turn-device`."""
