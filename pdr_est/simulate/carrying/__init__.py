"""Carrying."""
