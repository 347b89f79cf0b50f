"""Sensor Logger (Kelvin Choi, tszheichoi): exports of the app, and the messages that it pushes while recording.

=============  =========================================================================================
file           content
=============  =========================================================================================
reader         from an export to a recording
export         the tables of an export: CSV files or JSON
clock          Unix time of the start, and times of the position fixes
live           from messages over HTTP, one at a time, to samples, fixes and notes
live_messages  the content of one message
=============  =========================================================================================
"""
