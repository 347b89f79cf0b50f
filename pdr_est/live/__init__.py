"""Live page: a walk is tracked, recorded and shown while it happens. Needs the extra `live`.

===============  =========================================================================================
file             content
===============  =========================================================================================
session          one walk: samples come in, poses go out, everything received is recorded
tracking         the filter in a thread of its own
receivers/       the ways in which the samples of a phone arrive
replaying        a recording in place of phones
phones           what each phone sends, and in words what is missing
poses            poses as a page gets them
recording_files  the recording, which survives a program that is killed
final_report     the smoothed walk and its report at the end
server           the web application
visitor          one page that is open somewhere
serving          ports and their servers
strangers        connections without a token: few, and none for long
addresses        secret parts of addresses, QR code, certificate
limits           how much a client may send
===============  =========================================================================================
"""
