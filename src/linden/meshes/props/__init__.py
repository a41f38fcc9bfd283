"""What props look like: solids put together, stretched to the boxes of their blueprints."""
