"""The package's own files, `radmpc/scenario/1` and `radmpc/plan/1`."""
