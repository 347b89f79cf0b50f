"""Walker."""
