"""Commands that follow a walk while it is recorded."""
