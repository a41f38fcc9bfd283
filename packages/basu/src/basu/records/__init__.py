"""Records of drives: BASU's own history, and CARLA's recorder files."""
