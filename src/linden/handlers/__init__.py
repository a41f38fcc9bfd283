"""What a client can call, one file a family."""
