"""Flights written down: missions that record every tick, booked again from the rows alone."""
