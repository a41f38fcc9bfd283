"""Scores and infractions as functions of a recorded history."""
