"""What the operating system does for others: files replaced whole, processes beyond Ctrl-C."""
