"""One file a sensor, whatever the app: `Accelerometer.csv` and `Gyroscope.csv`, or `acce.txt` and `gyro.txt`.

==========  ============================================================================================
file        content
==========  ============================================================================================
reader      the files of one walk as one device
grouping    which files belong to one walk, and which sensor each holds
known_apps  apps that write such files, by what is typical of them
==========  ============================================================================================
"""
