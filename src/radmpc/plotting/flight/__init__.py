"""The picture and the film of a flight."""
