"""One file a sensor, whatever the app: `Accelerometer.csv` and `Gyroscope.csv`, or `acce.txt` and `gyro.txt`.

=============  =========================================================================================
file           content
=============  =========================================================================================
reader         the files of one walk, put on one clock
grouping       which files belong to one walk, and which sensor each holds
columns        time and axes of one file, by its titles, or by its values where it has none
known_apps     apps that write such files, by what is typical of them
=============  =========================================================================================
"""
