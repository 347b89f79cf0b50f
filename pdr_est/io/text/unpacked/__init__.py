"""Files that hold tables in another form than rows of text, as folders of such tables.

=============  ==============================================================
file           content
=============  ==============================================================
tables_source  a file whose tables are members, for every format
workbook       an Excel workbook, with a member for each sheet
json_records   JSON with lists of records, or of the values of each column
=============  ==============================================================
"""
