"""Fusion of the tracks of several devices into the track of the person who carries them."""
