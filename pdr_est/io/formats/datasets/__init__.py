"""Public data sets, in the layout in which their authors published them.

=============  =========================================================================================
file           recordings
=============  =========================================================================================
ilc20          Indoor Location Competition 2.0, Android
oxiod          Oxford Inertial Odometry Dataset, iPhone
weallwalk/     WeAllWalk, two iPhones of blind and sighted walkers
motionsense    MotionSense, iPhone, activities
oxford_steps   Oxford step counting data set, Android
stride_length  held phone with a foot sensor that measures strides, Android
sisfall        SisFall, a box at the belt, activities and falls
wisdm          WISDM, Android phone or watch, activities
ronin          RoNIN, Android, positions of a second phone
ridi           RIDI, Android, positions of the same phone
euroc          the layout of EuRoC and TUM VI, a camera rig, positions
ipin2021       IPIN 2021, Android, waypoints
=============  =========================================================================================
"""
