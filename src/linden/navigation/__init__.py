"""Where walkers can go: a mesh of pavements and crosswalks, in the form that the client reads."""
