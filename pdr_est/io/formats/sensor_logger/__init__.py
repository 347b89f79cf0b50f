"""Sensor logger."""
