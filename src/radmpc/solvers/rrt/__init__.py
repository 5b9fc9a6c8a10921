"""Rapidly-exploring random trees over the controls: no optimizer at all."""
