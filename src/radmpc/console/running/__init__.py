"""How commands run and end: workers, interrupts, exit codes."""
