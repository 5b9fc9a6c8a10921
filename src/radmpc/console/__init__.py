"""What the command line shows and how it ends: reports, progress, interrupts, exit codes."""
