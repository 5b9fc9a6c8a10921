"""Quick candidates: what flies already, its half-spaces turned to where vehicles are now."""
