"""Plain CSV: tables of one phone with a header line, and the project's own format, which is one of them.

=======  ================================================================================================
file     content
=======  ================================================================================================
reader   from a table to a recording
writer   from a recording to a table
mapped   tables whose columns a person has named
unknown  what to say of a file that is not read
=======  ================================================================================================
"""
