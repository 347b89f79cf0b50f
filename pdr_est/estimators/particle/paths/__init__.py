"""What the paths that a smoother draws say of a pose."""
