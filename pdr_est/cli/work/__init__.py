"""The work of the commands, one module each, which is loaded when a command is run and not for its help text."""
