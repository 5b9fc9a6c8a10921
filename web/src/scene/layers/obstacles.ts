/** Obstacles: those that stay, and those that move, where they are at the time shown. */

import type { ObstacleView, ScenarioView } from "../../protocol";
import { samePath } from "../../state/selection";
import type { Camera } from "../camera";
import { covariances, ellipseAt, num, shapeOf, type Shape } from "../geometry";
import type { Frame, Layer } from "../frame";
import { sigmasOf } from "../words";

/** Number of places at which a moving obstacle is shown faintly, at most. */
const GHOSTS = 6;

/** Dashes around what only some vehicles may not enter [px]. */
const PARTLY = [6, 4];

const ellipse = new Float64Array(3);
const spreads = new WeakMap<ObstacleView, Float64Array>();

export const drawObstacles: Layer = (ctx, frame) => {
  const { scenario } = frame;
  if (scenario === null) return;
  const standing = scenario.obstacles.filter(({ moving }) => moving === null);
  drawStanding(ctx, frame, standing.filter(({ only }) => only === null));
  const some = standing.filter(({ only }) => only !== null);
  if (some.length === 0) return;
  // Others pass through: less of a wall, and it says for whom it is one.
  ctx.setLineDash(PARTLY);
  ctx.globalAlpha = 0.5;
  drawStanding(ctx, frame, some);
  ctx.globalAlpha = 1;
  ctx.setLineDash([]);
};

function drawStanding(ctx: CanvasRenderingContext2D, { camera, colors }: Frame, obstacles: readonly ObstacleView[]): void {
  ctx.fillStyle = colors.obstacle;
  ctx.strokeStyle = colors.obstacleEdge;
  ctx.lineWidth = 1;
  ctx.beginPath();
  for (const obstacle of obstacles) {
    if (obstacle.kind !== "line") addRings(ctx, camera, shapeOf(obstacle), true);
  }
  ctx.fill();
  ctx.stroke();
  ctx.lineWidth = 2.5;
  ctx.beginPath();
  for (const obstacle of obstacles) {
    if (obstacle.kind === "line") addRings(ctx, camera, shapeOf(obstacle), false);
  }
  ctx.stroke();
}

/** Adds the outlines to the path, unless they are out of sight. */
function addRings(ctx: CanvasRenderingContext2D, camera: Camera, shape: Shape, isClosed: boolean): void {
  if (isOutOfSight(camera, shape)) return;
  for (const ring of shape.rings) {
    for (let i = 0; i < ring.length; i += 2) {
      const px = camera.px(num(ring, i));
      const py = camera.py(num(ring, i + 1));
      if (i === 0) ctx.moveTo(px, py);
      else ctx.lineTo(px, py);
    }
    if (isClosed) ctx.closePath();
    // A post has neither inside nor length.
    if (ring.length <= 2) ctx.arc(camera.px(num(ring, 0)), camera.py(num(ring, 1)), 2, 0, 2 * Math.PI);
  }
}

function isOutOfSight(camera: Camera, { bounds }: Shape): boolean {
  return (
    camera.px(bounds.maxX) < 0 || camera.px(bounds.minX) > camera.width ||
    camera.py(bounds.minY) < 0 || camera.py(bounds.maxY) > camera.height
  );
}

export const drawMovingObstacles: Layer = (ctx, frame) => {
  const { scenario, switches } = frame;
  if (scenario === null) return;
  for (const obstacle of scenario.obstacles) {
    if (obstacle.moving === null && obstacle.uncertain === null) continue;
    if (switches.ghosts && obstacle.moving !== null) drawGhosts(ctx, frame, scenario, obstacle);
    drawUncertainty(ctx, frame, obstacle);
    if (obstacle.moving !== null) drawMoving(ctx, frame, obstacle);
  }
};

function drawMoving(ctx: CanvasRenderingContext2D, frame: Frame, obstacle: ObstacleView): void {
  const { colors } = frame;
  ctx.fillStyle = colors.obstacle;
  ctx.strokeStyle = colors.obstacleEdge;
  ctx.lineWidth = obstacle.kind === "line" ? 2.5 : 1.25;
  if (obstacle.only !== null) ctx.setLineDash(PARTLY);
  ctx.beginPath();
  addMoved(ctx, frame.camera, obstacle, frame.time);
  if (obstacle.kind !== "line") ctx.fill();
  ctx.stroke();
  ctx.setLineDash([]);
}

function drawGhosts(ctx: CanvasRenderingContext2D, frame: Frame, scenario: ScenarioView, obstacle: ObstacleView): void {
  const stride = Math.max(1, Math.ceil(scenario.horizon / GHOSTS));
  ctx.strokeStyle = frame.colors.obstacleEdge;
  ctx.globalAlpha = 0.45;
  ctx.lineWidth = 0.75;
  ctx.beginPath();
  for (let k = 0; k <= scenario.horizon; k += stride) addMoved(ctx, frame.camera, obstacle, k);
  ctx.stroke();
  ctx.globalAlpha = 1;
}

/** Corners displaced one by one, as the protocol numbers them. */
function addMoved(ctx: CanvasRenderingContext2D, camera: Camera, obstacle: ObstacleView, time: number): void {
  let corner = 0;
  for (const ring of obstacle.rings) {
    for (let i = 0; i < ring.length; i += 1, corner += 1) {
      const px = camera.px((ring[i]?.[0] ?? 0) + displacement(obstacle, time, corner, 0));
      const py = camera.py((ring[i]?.[1] ?? 0) + displacement(obstacle, time, corner, 1));
      if (i === 0) ctx.moveTo(px, py);
      else ctx.lineTo(px, py);
    }
    if (obstacle.kind !== "line") ctx.closePath();
  }
}

/** How far a corner has moved along an axis at a time [steps], in m. */
export function displacement(obstacle: ObstacleView, time: number, corner: number, axis: number): number {
  const steps = obstacle.moving;
  if (steps === null) return 0;
  const at = Math.min(Math.max(time, 0), steps.length - 1);
  const i = Math.min(Math.floor(at), Math.max(steps.length - 2, 0));
  const before = steps[i]?.[corner]?.[axis] ?? 0;
  const after = steps[i + 1]?.[corner]?.[axis] ?? before;
  return before + (at - i) * (after - before);
}

function drawUncertainty(ctx: CanvasRenderingContext2D, frame: Frame, obstacle: ObstacleView): void {
  if (obstacle.uncertain === null) return;
  const { camera, colors, time } = frame;
  const spread = spreads.get(obstacle) ?? covariances(obstacle.uncertain);
  spreads.set(obstacle, spread);
  ellipseAt(spread, time, ellipse);
  const sigmas = sigmasOf(frame.plan) * camera.scale;
  const shape = shapeOf(obstacle);
  const px = camera.px(shape.x + displacement(obstacle, time, 0, 0));
  const py = camera.py(shape.y + displacement(obstacle, time, 0, 1));
  ctx.beginPath();
  ctx.ellipse(px, py, sigmas * num(ellipse, 0), sigmas * num(ellipse, 1), -num(ellipse, 2), 0, 2 * Math.PI);
  ctx.setLineDash([3, 3]);
  ctx.lineWidth = 1;
  ctx.strokeStyle = colors.muted;
  ctx.stroke();
  ctx.setLineDash([]);
}

/** Outline of what is selected or pointed at. */
export const drawObstacleMarks: Layer = (ctx, frame) => {
  const { scenario, selected, hovered, highlight, colors } = frame;
  if (scenario === null) return;
  for (const obstacle of scenario.obstacles) {
    const isSelected = selected?.kind === "obstacle" && samePath(selected.path, obstacle.path);
    const isPointedAt =
      (hovered?.kind === "obstacle" && samePath(hovered.path, obstacle.path)) ||
      highlight?.obstacles.includes(obstacle.name) === true;
    if (!isSelected && !isPointedAt) continue;
    ctx.strokeStyle = isSelected || highlight !== null ? colors.accent : colors.muted;
    ctx.lineWidth = isSelected ? 2 : 1.5;
    ctx.beginPath();
    if (obstacle.moving !== null) addMoved(ctx, frame.camera, obstacle, frame.time);
    else addRings(ctx, frame.camera, shapeOf(obstacle), obstacle.kind !== "line");
    ctx.stroke();
  }
};
