"""Plain csv."""
