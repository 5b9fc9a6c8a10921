"""Logs as tracks: CSV, MCAP, ROS 2 bags and PX4 ULog."""
