"""What `closed_loop.py` flies: scenes, rules of accounting, and what one would fly otherwise."""
