"""Documents: scenarios as their files have them, changed, undone, checked and saved."""
