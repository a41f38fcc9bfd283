"""CARLA's recorder files: bytes to packets and back, and reports about them."""
