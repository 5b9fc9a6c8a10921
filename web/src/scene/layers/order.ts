/** Layers from bottom to top. */

import type { Layer } from "../frame";
import { drawDraft, drawHandles } from "./editing";
import { drawGrid, drawGround, drawRulers, drawWorkspace } from "./grid";
import { drawMovingObstacles, drawObstacleMarks, drawObstacles } from "./obstacles";
import { drawGoals, drawTracks } from "./tracks";
import { drawVehicleMarks, drawVehicles } from "./vehicles";

/** Drawn when the camera, the scenario or the plan changes, not when time does. */
export const STILL: readonly Layer[] = [
  drawGround, drawGrid, drawWorkspace, drawObstacles, drawGoals, drawTracks,
];

/** Drawn in every frame. */
export const LIVE: readonly Layer[] = [
  drawMovingObstacles, drawVehicles, drawObstacleMarks, drawVehicleMarks, drawRulers, drawHandles, drawDraft,
];
