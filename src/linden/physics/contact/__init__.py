"""What happens where bodies meet: which pairs are near, where boxes overlap, what impulse parts them."""
