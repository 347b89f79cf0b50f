"""Robust dr."""
