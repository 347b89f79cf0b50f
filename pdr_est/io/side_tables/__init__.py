"""Side tables."""
