"""Formats of recorder apps and data sets; the content of a file decides its format, its name only the sensor.

=============  =========================================================================================
file           content
=============  =========================================================================================
registry       finds the format of a path and reads it
phone_apps/    apps of phones and watches
imu_devices/   sensors that are not phones
datasets/      public data sets, with their reference data
sensor_files/  one file a sensor, of any app
plain_csv/     any table with a time and three axes, and the project's own format
named_tables   what all tables of one known app or device have in common
=============  =========================================================================================

A format is a module with `NAME`, `sniff(source) -> bool` and `read_source(source) -> Recording` (see
`registry.Format`), listed in `registry.FORMATS`. `docs/recorder-formats.md` and `docs/recorders` describe them.
"""
