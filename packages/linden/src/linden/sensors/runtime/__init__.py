"""The sensors of an episode in each frame: scene, visible actors, schedules, measurements."""
