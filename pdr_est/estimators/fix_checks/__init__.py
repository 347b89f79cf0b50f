"""Comparison of the fixes of a walk with its steps, before a smoother takes them; `check` holds the function."""
