"""A package for CARLA built on Unreal: meshes by semantic group and tile as FBX, glTF and USD, and their folder."""
