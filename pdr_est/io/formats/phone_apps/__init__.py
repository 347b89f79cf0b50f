"""Recorder apps of phones and watches, by the name under which people know them.

===============  =======================================================================================
file             recordings
===============  =======================================================================================
sensor_logger/   Sensor Logger (tszheichoi), Android and iOS: exports, and messages while recording
phyphox/         phyphox, Android and iOS
getsensordata    GetSensorData, the app of the IPIN competition, Android
gnss_logger      Google's GnssLogger, Android
androsensor      AndroSensor, Android
physics_toolbox  Physics Toolbox Sensor Suite, Android and iOS
sensorlog        SensorLog, iOS
hyperimu         HyperIMU, Android
matlab_mobile    MAT files of MATLAB Mobile, Android and iOS
core_motion      tables of Core Motion by any app, iOS and Apple Watch
===============  =======================================================================================
"""
