"""Who keeps to whom, and whom obstacles concern."""
