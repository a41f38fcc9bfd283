"""CARLA's recorder and replayer: an episode into a file, and a file into an episode."""
