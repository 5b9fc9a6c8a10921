"""What the page draws, made from values of the model."""
