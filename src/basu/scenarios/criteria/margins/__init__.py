"""How narrowly: distances and times between the ego and everybody else, by their boxes."""
