"""What a plan can be flown in that does not move by its model: boats, drones, robots, autopilots.

Each simulator has a controller of its own that follows the mission's segments; what it leaves
undone is noise to the plan, which `radmpc calibrate` measures.
"""
