"""What the console says of plans: reports, reasons, progress."""
