"""Tables that a user or a data set puts beside a recording.

===============  =======================================================================================
file             content
===============  =======================================================================================
fix_table        the columns of a table of known positions, in many spellings
table_times      the times in such a table
position_fixes   known positions of the walker (`--fixes`)
clock_messages   messages by which devices compared their clocks (`--messages`, Robust DR section V-B)
known_distances  length and step count of walks, measured by hand
surveyed_walks   true positions, steps, carrying mode or speed of one walk
===============  =======================================================================================
"""
