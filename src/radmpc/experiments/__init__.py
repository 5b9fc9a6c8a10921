"""Benchmark families and experiments."""
