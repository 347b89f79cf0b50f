"""Read any table of sensor samples: what its columns mean, its clock, its signals, and one device of several tables.

===========  =========================================================================================
file         content
===========  =========================================================================================
quantities   quantities that columns hold, the documented titles, names of units
words        names of sensors in several languages
titles       understand one title: quantity, axis, unit
header       understand all titles of a table together
headerless   columns without titles, by their values
mapping      the record of what the columns mean, from titles or from a person
dates        dates and times of day
clock        the column that tells the time
timing       bursts of samples that share a stamp
signals      one table: from bytes to signals on the recorder's clock
device       one device of one or several tables
===========  =========================================================================================
"""
