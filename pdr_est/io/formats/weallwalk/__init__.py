"""Weallwalk."""
