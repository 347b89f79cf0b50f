"""Sensor Logger (Kelvin Choi, tszheichoi): exports of the app, and the messages that it pushes while recording.

=================  =========================================================================================
file               content
=================  =========================================================================================
reader             from an export to a recording
annotations        positions that the walker typed
reading            what was decided and used while an export is read
acceleration       specific force, from whichever acceleration there is
watch              the device at the wrist
export             the tables of an export: CSV files or JSON
combined_export    the tables in one CSV file
database_export    the tables in an SQLite database
sensor_names       names of the sensors in files, columns and readings
clock              Unix time of the start, and times of the position fixes
live               from messages over HTTP, one at a time, to samples, fixes and notes
live_messages      the content of one message
=================  =========================================================================================
"""
