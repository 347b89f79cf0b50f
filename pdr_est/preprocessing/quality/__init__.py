"""Quality of a recording: what it contains, what is wrong with it, and what can be computed from it.

===================  ===============================================================================================
file                 content
===================  ===============================================================================================
sensor_checks        numerical checks of one sensor: clock, true sampling rate, clipping, standstill of the values
sampling_rate        sampling rates that are too low for steps
gyroscope_check      gyroscope against gravity: axes, signs, gains and clock
gyroscope_fit        bias and gains of a gyroscope that keep gravity in place
accelerometer_check  length of gravity in every posture: gain and offset of the axes
consistency          the checks of the sensors of a device against each other
capabilities         what can be computed from the sensors of a device
inspection           all checks of a recording as one record (`pdr-est inspect`)
inspection_text      that record as readable text
requirements         refuse recordings from which steps or a track cannot be computed
warnings             warn of recordings whose steps or track are doubtful
===================  ===============================================================================================
"""
