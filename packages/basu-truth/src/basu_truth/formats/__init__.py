"""The formats of public devkits: one module each."""
