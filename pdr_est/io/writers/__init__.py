"""Contents of result files; `pdr_est.output` writes them.

============  =========================================================================================
file          content
============  =========================================================================================
steps_table   CSV table of the detected steps
trajectories  tables of poses: TUM without and with covariance, and `timestamp,x,y,yaw,floor`
geojson       GeoJSON with lines, points with times, and ellipses
kml           KML for Google Earth
gpx           GPX for navigation programs and devices
geodesy       positions, ellipses and times as map formats need them
parquet       tables as Parquet files
checksums     SHA-256 of input files
============  =========================================================================================
"""
