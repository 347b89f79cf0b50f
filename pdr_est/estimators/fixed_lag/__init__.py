"""Fixed-lag smoother: poses with a constant delay."""
