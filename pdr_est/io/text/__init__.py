"""Reading of files: from paths to bytes, and from text tables to arrays, whatever the recorder.

==============  =========================================================================================
file            content
==============  =========================================================================================
archives        subpackage: unpack compressed data piece by piece against a limit
container       open a file, a folder or a zip archive, plain or gzipped, and read its members safely
single_archive  a folder that holds nothing but one archive
unpacked        subpackage: Excel workbooks and JSON as folders of tables
members         find the member that holds the recording
encoding        bring any encoding to UTF-8
cells           split a line into cells, and tell what one holds: a number, a date, nothing or text
table_layout    separator, decimal mark, header, units and first row of any table, also without rows
loose_table     parse such a table, with damaged rows left out and told
whole_rows      collect the whole rows of a table that has damaged ones
text_columns    convert columns that were read as text to numbers
header_rows     titles, units and types above the first row
number_table    parse a table of numbers, with errors that name line, column and value
tagged_lines    parse a log that mixes the rows of many sensors, each tagged with its type
finite_values   signals without NaN, and numbers without values that no sensor can measure
==============  =========================================================================================
"""
