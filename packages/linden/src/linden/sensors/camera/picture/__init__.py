"""The colour picture: light of sun, sky and lamps on surfaces, through air, smoothed and developed like a film."""
