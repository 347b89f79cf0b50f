"""Files that hold more than one table: of several sensors in turn, of several devices, or one below the other.

============  ==========================================================================================
file          content
============  ==========================================================================================
reader        from a file to the tables of each of its devices
owners        columns that tell whose row it is: of one of several devices, persons or sessions
sections      tables one below the other, each with a header of its own
long_table    one row a sample, with the sensor's name in a column
tagged_log    rows that begin with the name of their kind, each kind with columns of its own
respelt       vectors in one cell, and one value a row, brought to one sample a row
============  ==========================================================================================
"""
