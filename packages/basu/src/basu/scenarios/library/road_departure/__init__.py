"""The ego is on its way off the road."""
