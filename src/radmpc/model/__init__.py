"""The data model: scenarios and plans."""
