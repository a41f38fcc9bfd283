"""What actors look like: solids put together to cars, people and things, true to their blueprints' boxes."""
