"""What `hunt.py` and `hunt_flights.py` draw, try, and hold to be wrong."""
