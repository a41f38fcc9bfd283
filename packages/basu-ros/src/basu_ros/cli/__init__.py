"""The commands ``basu ros``."""
