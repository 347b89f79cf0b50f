"""Read any table of sensor samples: what its columns mean, its clock, its signals, and one device of several tables.

============  ========================================================================================
file          content
============  ========================================================================================
quantities    quantities that columns hold, the documented titles, names of units
words/        names of sensors and columns in several languages
titles        understand one title: quantity, axis, unit
header        understand all titles of a table together
headerless    columns without titles, by their values
mapping       the record of what the columns mean, from titles or from a person
mapping_file  that record as a YAML file
times/        dates, clocks, samples that share a stamp
values/       what the values tell: rows of codes, units, gravity, the order of axes
signals       one table: from bytes to signals on the recorder's clock
split         long tables and tagged logs: several sensors in one file
placed        signals of several tables on one clock
device        one device of one or several tables
recognition   whether a file is a table with motion, and what was seen if not
============  ========================================================================================
"""
