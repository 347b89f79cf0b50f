"""Times of the rows of a table.

==============  ===================================================================
file            content
==============  ===================================================================
clock           the column that tells the time best, and stale first rows
candidates      one column read as times
clock_units     the unit and the beginning of a numeric clock
counter         counters that start anew at zero
unset           rows whose time was never set
joined_columns  whole seconds with their fraction, dates with the time of day
dates           dates and times of day
fractions       the digits behind the seconds
scripts         dates in Chinese, Japanese and Korean
date_parts      year, month … second in a column each
calendar        days since 1970, and midnight
sensor_clocks   sensors with clocks of their own side by side
bursts          samples that share a stamp, spread evenly
uneven_bursts   bursts of varying size, spread at a steady rate
==============  ===================================================================
"""
