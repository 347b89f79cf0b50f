"""Contents of result files; `pdr_est.output` writes them.

===========  ==========================================================================================
file         content
===========  ==========================================================================================
track_files  TUM and GeoJSON tracks, and the CSV table of steps
parquet      tables as Parquet files
checksums    SHA-256 of input files
===========  ==========================================================================================
"""
