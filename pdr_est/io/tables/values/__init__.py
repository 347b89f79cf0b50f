"""Settling by the values of columns: rows without a measurement, units, gravity, the order of axes.

=================  ===================================================================
file               content
=================  ===================================================================
impossible_values  rows that hold codes, zeros or spikes
zero_filled        rows with the sample of one sensor and zeros for the others
measurements       the values of one sensor in one unit, without rows of codes
column_units       the unit of an axis that states none, by the other axes
settling           what titles leave open, settled by the values
angle_axes         the axes of alpha, beta, gamma or of pitch and roll
=================  ===================================================================
"""
