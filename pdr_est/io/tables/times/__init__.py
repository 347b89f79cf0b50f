"""Times of the rows of a table.

======  ============================================
file    content
======  ============================================
dates   dates and times of day
clock   the column that tells the time, and its unit
bursts  samples that share a stamp, spread evenly
======  ============================================
"""
