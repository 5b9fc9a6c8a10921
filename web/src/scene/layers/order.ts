/** Layers from bottom to top. */

import type { Layer } from "../frame";
import { drawCompared, drawComparedNow } from "./compare";
import { drawDraft, drawHandles } from "./editing";
import { drawFlight } from "./flight";
import { drawGrid, drawGround, drawRulers, drawWorkspace } from "./grid";
import { drawMovingObstacles, drawObstacleMarks, drawObstacles } from "./obstacles";
import { drawNames } from "./names";
import { drawRanges } from "./ranges";
import { drawRisk } from "./risk";
import { drawGoals, drawTracks } from "./tracks";
import { drawTrails } from "./trails";
import { drawVehicleMarks, drawVehicles } from "./vehicles";

/** Drawn when the camera, the scenario or the plan changes, not when time does. */
export const STILL: readonly Layer[] = [
  drawGround, drawGrid, drawWorkspace, drawObstacles, drawGoals, drawTrails, drawCompared, drawTracks,
];

/** Drawn in every frame. */
export const LIVE: readonly Layer[] = [
  drawMovingObstacles, drawRanges, drawVehicles, drawComparedNow, drawFlight, drawRisk,
  drawNames, drawObstacleMarks, drawVehicleMarks, drawRulers, drawHandles, drawDraft,
];
