"""What vehicles and people look like: solids put together, true to their blueprints' boxes."""
