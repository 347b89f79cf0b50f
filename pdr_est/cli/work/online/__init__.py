"""Work of the commands that follow a walk while it is recorded."""
