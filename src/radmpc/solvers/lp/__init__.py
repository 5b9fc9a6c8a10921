"""Linear programs kept alive in HiGHS: rows added once, solved warm, bounds proven from duals."""
