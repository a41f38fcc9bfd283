"""Agents under test, and their base class."""
