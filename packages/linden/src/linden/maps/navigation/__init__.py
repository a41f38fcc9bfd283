"""The walking mesh: pavements and crosswalks in the form that CARLA's client reads."""
