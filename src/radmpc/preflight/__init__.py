"""What an operator should know of a scenario before it is planned, without planning it."""
