"""Phyphox."""
