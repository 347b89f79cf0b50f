"""Exports of inertial sensors that are not phones.

========  ==============================================================================================
file      recordings
========  ==============================================================================================
xsens     Xsens and Movella: DOT, Awinda, MT Manager
shimmer   Shimmer, by Consensys
xio       x-io Technologies: x-IMU3, NGIMU
flysight  FlySight 2
ros_csv   messages `sensor_msgs/Imu` of ROS as CSV
========  ==============================================================================================
"""
