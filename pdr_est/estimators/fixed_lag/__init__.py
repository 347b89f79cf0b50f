"""Fixed lag."""
