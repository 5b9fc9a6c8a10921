"""Which way half-spaces are turned: the directions that paths are clearest of something along."""
