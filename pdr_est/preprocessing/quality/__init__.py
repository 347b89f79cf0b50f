"""Quality of a recording: what it contains, what is wrong with it, and what can be computed from it.

===============  ===================================================================================================
file             content
===============  ===================================================================================================
sensor_checks    numerical checks of one sensor: clock, true sampling rate, clipping, standstill of the values
inspection       all checks of a recording as one record (`pdr-est inspect`)
inspection_text  that record as readable text
requirements     refuse recordings from which steps or a track cannot be computed
warnings         warn of recordings whose steps or track are doubtful
===============  ===================================================================================================
"""
