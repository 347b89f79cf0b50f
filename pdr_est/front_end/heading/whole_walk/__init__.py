"""Whole walk."""
