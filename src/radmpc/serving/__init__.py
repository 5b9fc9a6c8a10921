"""A page to look at: scenarios drawn, planned and flown in a browser on this machine."""
