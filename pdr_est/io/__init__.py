"""Recorder formats, resampling onto the working grid, and the files that a track is written to."""

from pdr_est.io.formats.registry import read

__all__ = ["read"]
