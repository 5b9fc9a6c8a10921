"""What is left of a certificate once a part of the plan has been flown and measured."""
