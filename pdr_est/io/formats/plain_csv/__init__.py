"""Plain CSV: tables of one phone with a header line, and the project's own format, which is one of them.

======  ================================================================================================
file    content
======  ================================================================================================
header  meaning of the column titles
clock   the time column
reader  from a table to a recording
writer  from a recording to a table
======  ================================================================================================
"""
