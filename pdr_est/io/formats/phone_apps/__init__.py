"""Recorder apps of phones and watches, by the name under which people know them.

==================  ==================================================================================
file                recordings
==================  ==================================================================================
sensor_logger/      Sensor Logger (tszheichoi), Android and iOS: exports, and messages while recording
phyphox/            phyphox, Android and iOS
getsensordata       GetSensorData, the app of the IPIN competition, Android
==================  ==================================================================================
"""
