"""Whether vehicles get to their visits and goals in time with nothing in the way, and why not."""
