"""What limits and goals ask of a vehicle in any case: its hard rows, and the faces of norms."""
