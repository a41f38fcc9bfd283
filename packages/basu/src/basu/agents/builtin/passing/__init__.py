"""Leaving the lane and returning: to pass an obstruction, or to make room for a tailgater."""
