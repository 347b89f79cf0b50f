"""Conversion of recorded values to the units, axes and signs of the project.

================  ======================================================================================
file              content
================  ======================================================================================
raw_device        settle gravity, units and signs of the signals of one device, whatever they come from
units             detect the unit of accelerations, rotation rates, pressures and clocks from the values
rotation_unit     detect the unit of a rotation rate from the motion that the accelerometer saw
gravity_content   tell whether an acceleration contains gravity
restored_gravity  restore gravity by the recorded attitude
gravity_parts     put gravity and the acceleration without it together
gravity_windows   windows of accelerometer and gyroscope, and the rotation in them
gravity_drift     movement of gravity that the gyroscope's rotation leaves
signs             detect the sign of the acceleration and the direction of the attitude
sign_evidence     weigh what tells that sign where there is no attitude
axes              attitude and gravity of Android and Apple (Core Motion) in the project's axes
gnss              convert latitude and longitude to position fixes in the map frame
stale_samples     samples from before the recording
================  ======================================================================================
"""
