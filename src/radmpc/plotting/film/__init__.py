"""Films of plans."""
