"""What starts and goals risk by themselves, whatever the plan."""
