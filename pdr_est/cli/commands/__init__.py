"""The commands of `pdr-est`, one module each."""
