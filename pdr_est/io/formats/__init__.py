"""Formats of recorder apps and data sets; the content of a file decides its format, never its name.

================  ======================================================================================
file              recordings
================  ======================================================================================
registry          finds the format of a path and reads it
sensor_logger/    Sensor Logger (tszheichoi), Android and iOS: exports, and messages while recording
phyphox/          phyphox, Android and iOS
getsensordata     GetSensorData, the app of the IPIN competition, Android
plain_csv/        any table with a header that names its columns, and the project's own format
ilc20             Indoor Location Competition 2.0, Android
oxiod             Oxford Inertial Odometry Dataset, iPhone
weallwalk/        WeAllWalk, two iPhones of blind and sighted walkers
motionsense       MotionSense, iPhone, activities
oxford_steps      Oxford step counting data set, Android
stride_length     held phone with a foot sensor that measures strides, Android
sisfall           SisFall, a box at the belt, activities and falls
================  ======================================================================================

A format is a module with `NAME`, `sniff(source) -> bool` and `read_source(source) -> Recording` (see
`registry.Format`), listed in `registry.FORMATS`. `docs/recorder-formats.md` describes every format.
"""
