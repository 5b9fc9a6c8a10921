"""What one would use instead of radmpc, on the same scenarios and before the same referee.

`statement` turns a scenario into numbers, each ``with_*`` module is a model of its own, `worker`
runs one of them in a process of its own, `harness` asks workers and has their controls judged,
`tables` shows the outcome.
"""
