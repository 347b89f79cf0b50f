"""Names that recorders give to sensors and columns, in several languages.

All are joined without separators, case and accents, as `titles.split_words` writes them. `sensors` has those of
sensors with axes, `owners` those of columns that tell whose row it is, `columns` those of the other columns. A name
that is absent can still be given in a mapping file.
"""
