"""Risk for a mile: encounters, failure probabilities of played cases, and injury curves, with their uncertainty."""
