"""Others who come towards the ego in its own lane."""
