"""Other legs than the one in the air: who makes them, how they are judged, and in what time."""
