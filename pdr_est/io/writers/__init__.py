"""Writing of result files.

=============  =========================================================================================
file           content
=============  =========================================================================================
atomic_output  folders and files that appear completely or not at all
track_files    TUM and GeoJSON tracks, and the CSV table of steps
parquet        tables as Parquet files
checksums      SHA-256 of input files
=============  =========================================================================================
"""
