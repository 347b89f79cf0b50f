"""Factor graph."""
