"""CARLA's recorder files: bytes to packets and back, and the reports about them. Knows no simulation."""
