"""Leaving the lane and coming back: round what stands in it, or out of the way of who is close behind."""
