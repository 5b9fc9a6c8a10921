/**
 * What is under the pointer.
 *
 * Bounds of shapes and tracks are compared first, which for thousands of them takes less than the
 * upkeep of a search tree would.
 */

import { samePath, type Thing } from "../state/selection";
import { handlesOf } from "../edit/things";
import type { GoalView, ScenarioView } from "../protocol";
import type { Frame } from "./frame";
import { distanceTo, isInside, num, shapeOf, tracksOf } from "./geometry";
import { displacement } from "./layers/obstacles";
import { vehiclePixels } from "./layers/vehicles";

/** How far off the pointer may be [px]: a mouse, a finger. */
export const MOUSE = 7;
export const FINGER = 16;

export interface Grip {
  readonly thing: Thing;
  /** Which of its handles. */
  readonly index: number;
}

/** The handle under the pointer: of the selected thing, or a start or goal, which need not be selected. */
export function gripAt(frame: Frame, px: number, py: number, reach: number): Grip | null {
  const { scenario, selected, camera } = frame;
  if (scenario === null) return null;
  if (selected !== null) {
    const index = nearestHandle(scenario, selected, frame, px, py, reach);
    if (index >= 0) return { thing: selected, index };
  }
  const [x, y] = camera.toMap(px, py);
  const thing = thingOfVehicleAt(scenario, x, y, Math.max(reach - 2, 4) / camera.scale);
  if (thing !== null && handlesOf(scenario, thing).length > 0) return { thing, index: 0 };
  if (selected?.kind === "obstacle" && thingAt(frame, px, py, reach)?.kind === "obstacle") {
    const under = thingAt(frame, px, py, reach);
    if (under !== null && samePath(under.path, selected.path)) return { thing: selected, index: 0 };
  }
  return null;
}

function nearestHandle(
  scenario: ScenarioView, thing: Thing, { camera }: Frame, px: number, py: number, reach: number,
): number {
  let best = -1;
  let least = reach + 2;
  handlesOf(scenario, thing).forEach((handle, i) => {
    const far = Math.hypot(camera.px(num(handle.at, 0)) - px, camera.py(num(handle.at, 1)) - py);
    // Of handles on one spot, a corner goes before the whole.
    if (far < least || (far === least && best === 0)) {
      best = i;
      least = far;
    }
  });
  return best;
}

/** A start, a goal or a place to visit. */
function thingOfVehicleAt(scenario: ScenarioView, x: number, y: number, reach: number): Thing | null {
  for (let i = scenario.vehicles.length - 1; i >= 0; i -= 1) {
    const vehicle = scenario.vehicles[i];
    if (vehicle === undefined) continue;
    if (Math.hypot(num(vehicle.start, 0) - x, num(vehicle.start, 1) - y) < reach) {
      return { kind: "vehicle", path: vehicle.path };
    }
    for (const visit of vehicle.via) {
      if (isInBox(visit, x, y, reach)) return { kind: "waypoint", path: visit.path };
    }
    if (isInBox(vehicle.goal, x, y, reach)) return { kind: "goal", path: vehicle.goal.path };
  }
  return null;
}

/** Small boxes are taken by their surroundings, large ones only inside. */
function isInBox({ box }: GoalView, x: number, y: number, reach: number): boolean {
  const slack = (axis: number) => {
    const half = (num(box.max, axis) - num(box.min, axis)) / 2;
    return Math.max(half, reach) - half;
  };
  return (
    x >= num(box.min, 0) - slack(0) && x <= num(box.max, 0) + slack(0) &&
    y >= num(box.min, 1) - slack(1) && y <= num(box.max, 1) + slack(1)
  );
}

/** The thing under the pointer: the smallest kind first. */
export function thingAt(frame: Frame, px: number, py: number, reach: number): Thing | null {
  const { scenario, camera } = frame;
  if (scenario === null) return null;
  const [x, y] = camera.toMap(px, py);
  const slack = reach / camera.scale;
  return (
    movingVehicleAt(frame, px, py, reach) ??
    thingOfVehicleAt(scenario, x, y, slack) ??
    obstacleAt(frame, scenario, x, y, slack, true) ??
    trackAt(frame, x, y, slack) ??
    obstacleAt(frame, scenario, x, y, slack, false) ??
    workspaceAt(scenario, x, y, slack)
  );
}

/** A vehicle where it is at the time shown. */
function movingVehicleAt(frame: Frame, px: number, py: number, reach: number): Thing | null {
  if (frame.plan === null) return null;
  const pixels = vehiclePixels(frame);
  const { vehicles } = frame.plan.scenario;
  for (let i = vehicles.length - 1; i >= 0; i -= 1) {
    const radius = Math.max((vehicles[i]?.radius ?? 0) * frame.camera.scale, reach);
    if (Math.hypot(num(pixels, 2 * i) - px, num(pixels, 2 * i + 1) - py) < radius) return named(frame, i);
  }
  return null;
}

function trackAt(frame: Frame, x: number, y: number, slack: number): Thing | null {
  if (frame.plan === null || !frame.switches.tracks) return null;
  const { paths, bounds } = tracksOf(frame.plan);
  for (let i = paths.length - 1; i >= 0; i -= 1) {
    const around = bounds[i];
    const path = paths[i];
    if (around === undefined || path === undefined) continue;
    if (x < around.minX - slack || x > around.maxX + slack || y < around.minY - slack || y > around.maxY + slack) continue;
    if (distanceTo(path, false, x, y) < slack) return named(frame, i);
  }
  return null;
}

/** The scenario's vehicle of the name that the plan's has. */
function named({ plan, scenario }: Frame, index: number): Thing | null {
  const name = plan?.tracks[index]?.name;
  const same = scenario?.vehicles[index];
  const vehicle = same?.name === name ? same : scenario?.vehicles.find((candidate) => candidate.name === name);
  return vehicle === undefined ? null : { kind: "vehicle", path: vehicle.path };
}

function obstacleAt(
  frame: Frame, scenario: ScenarioView, x: number, y: number, slack: number, isEdge: boolean,
): Thing | null {
  for (let i = scenario.obstacles.length - 1; i >= 0; i -= 1) {
    const obstacle = scenario.obstacles[i];
    if (obstacle === undefined) continue;
    const shape = shapeOf(obstacle);
    const mx = x - displacement(obstacle, frame.time, 0, 0);
    const my = y - displacement(obstacle, frame.time, 0, 1);
    const { bounds } = shape;
    if (mx < bounds.minX - slack || mx > bounds.maxX + slack) continue;
    if (my < bounds.minY - slack || my > bounds.maxY + slack) continue;
    const isLine = obstacle.kind === "line";
    const isHit = isEdge
      ? shape.rings.some((ring) => distanceTo(ring, !isLine, mx, my) < slack)
      : !isLine && isInside(shape, mx, my);
    if (isHit) return { kind: "obstacle", path: obstacle.path };
  }
  return null;
}

function workspaceAt({ workspace }: ScenarioView, x: number, y: number, slack: number): Thing | null {
  if (workspace === null) return null;
  const [minX = 0, minY = 0] = workspace.min;
  const [maxX = 0, maxY = 0] = workspace.max;
  if (x < minX - slack || x > maxX + slack || y < minY - slack || y > maxY + slack) return null;
  const far = Math.min(Math.abs(x - minX), Math.abs(x - maxX), Math.abs(y - minY), Math.abs(y - maxY));
  return far < slack ? { kind: "workspace", path: ["workspace"] } : null;
}
