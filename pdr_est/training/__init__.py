"""Training of the shipped models from folders of recordings."""
