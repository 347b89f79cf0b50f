"""Ways in which the samples of a phone arrive.

=============  =========================================================================================
file           content
=============  =========================================================================================
browser_phone  motion events that the page on a phone sends through its WebSocket
pushed         messages that Sensor Logger pushes by HTTP
phyphox        phyphox's remote access, which is polled
arrival        the clock of a phone beside that of this computer
=============  =========================================================================================
"""
