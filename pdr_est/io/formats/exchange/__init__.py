"""Formats to give recordings to other programs, written by `pdr-est convert` and read back.

====================  =======================================================================================
file                  content
====================  =======================================================================================
parquet_table         the columns of the documented plain table, as a Parquet file
synchronised_arrays   arrays on common times with RoNIN's names, as NumPy archive or HDF5
sensor_logger_folder  one table a sensor, as Sensor Logger exports them on Android
left_out              what a format has no place for
====================  =======================================================================================

`plain_csv.writer` writes the documented plain table itself.
"""
