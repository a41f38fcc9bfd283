"""Ray casting against triangles: Embree on the CPU, Warp on a GPU, one interface."""
