"""What the console reports about plans: reports, reasons, progress."""
