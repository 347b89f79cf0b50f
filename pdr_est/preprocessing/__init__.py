"""Preprocessing: from recordings as they were read to samples on a uniform grid, and checks of their quality.

================  ==================================================================================================
file              content
================  ==================================================================================================
merge             join the recordings of several devices of one walk
trim              cut a time span out of a recording
turned_device     turn the axes of the devices of a recording
resampling        resample the channels of a device onto a uniform grid (a stage: `SensorBlock` -> `ImuBlock`)
channel_integral  clean the samples of one channel and integrate them; used by the resampling
gravity_stand_in  a vertical for counting steps from an acceleration without gravity
sensor_ranges     largest values that the sensors of a phone can measure
quality           subpackage: inspect a recording, refuse or warn of what is wrong with it
================  ==================================================================================================
"""
