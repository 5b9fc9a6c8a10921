"""Grid worlds: libMultiRobotPlanning and MovingAI."""
