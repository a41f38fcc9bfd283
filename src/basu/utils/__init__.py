"""Shared by two folders or more: packaged files."""
