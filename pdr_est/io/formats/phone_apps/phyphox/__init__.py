"""phyphox: exports of the app by RWTH Aachen, Android and iOS.

=============  =========================================================================================
file           content
=============  =========================================================================================
reader         tables of the sensors
sensor_titles  sensors by the titles of the columns
metadata       when the experiment ran and paused, and on which phone
=============  =========================================================================================
"""
