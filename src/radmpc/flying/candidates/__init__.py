"""Other legs than the one in the air: how they are made and judged, and in what time."""
