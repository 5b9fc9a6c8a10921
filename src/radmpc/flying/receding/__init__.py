"""Missions longer than a program: planned a window at a time, all from one account."""
