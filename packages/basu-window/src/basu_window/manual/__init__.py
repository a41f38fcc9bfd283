"""A person at the wheel: keys, gamepad and wheel turned into controls; sessions of key presses, recorded and played."""
