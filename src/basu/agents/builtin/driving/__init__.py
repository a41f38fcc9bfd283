"""How the basic agent moves: its path, the speeds along it, and the hands and feet that follow them. No carla here."""
