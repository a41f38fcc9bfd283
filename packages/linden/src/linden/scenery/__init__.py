"""Everything that sensors see of a map: the scene as boxes, and meshes of streets, things, actors and props."""
