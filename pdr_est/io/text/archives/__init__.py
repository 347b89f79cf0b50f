"""Compressed data, unpacked in pieces against a limit, so that time and memory follow what is really there.

=========  ============================================================
file       content
=========  ============================================================
inflating  unpack deflate, gzip, bzip2 and LZMA data up to a limit
zip_files  list the members of a zip archive once, and read one safely
=========  ============================================================
"""
