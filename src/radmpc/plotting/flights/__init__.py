"""Pictures and films of flights."""
