"""What `calibration.py` draws, measures and reports."""
