/** Starts, goals, places to visit, and the tracks of a plan. */

import type { GoalView } from "../../protocol";
import type { Camera } from "../camera";
import { num, tracksOf, type Bounds } from "../geometry";
import type { Frame, Layer } from "../frame";

/** Detail of a track that is not drawn [px]. */
const DETAIL = 1.5;

/** Number of vehicles up to which the steps are marked along the tracks. */
const MAX_DOTTED = 64;

const TAU = 2 * Math.PI;

/** Indices of vehicles by color, so that each color is one path. */
export function byColor(colors: readonly string[]): ReadonlyMap<string, readonly number[]> {
  const known = groups.get(colors);
  if (known !== undefined) return known;
  const made = new Map<string, number[]>();
  colors.forEach((color, i) => {
    const group = made.get(color);
    if (group === undefined) made.set(color, [i]);
    else group.push(i);
  });
  groups.set(colors, made);
  return made;
}

const groups = new WeakMap<readonly string[], ReadonlyMap<string, readonly number[]>>();

export const drawGoals: Layer = (ctx, frame) => {
  const { scenario, camera, scenarioColors } = frame;
  if (scenario === null) return;
  ctx.lineWidth = 1.25;
  for (const [color, group] of byColor(scenarioColors)) {
    ctx.strokeStyle = color;
    ctx.fillStyle = color;
    ctx.beginPath();
    for (const i of group) {
      const vehicle = scenario.vehicles[i];
      if (vehicle === undefined) continue;
      addBox(ctx, camera, vehicle.goal);
    }
    ctx.globalAlpha = frame.colors.isDark ? 0.28 : 0.18;
    ctx.fill();
    ctx.globalAlpha = 1;
    ctx.stroke();
    drawVisits(ctx, frame, group);
    ctx.beginPath();
    for (const i of group) {
      const start = scenario.vehicles[i]?.start;
      if (start === undefined) continue;
      const px = camera.px(num(start, 0));
      const py = camera.py(num(start, 1));
      if (!isNear(camera, px, py)) continue;
      ctx.moveTo(px + 3.5, py);
      ctx.arc(px, py, 3.5, 0, TAU);
    }
    ctx.stroke();
  }
};

function drawVisits(ctx: CanvasRenderingContext2D, frame: Frame, group: readonly number[]): void {
  const { scenario, camera } = frame;
  ctx.beginPath();
  for (const i of group) {
    for (const visit of scenario?.vehicles[i]?.via ?? []) addBox(ctx, camera, visit);
  }
  ctx.setLineDash([3, 2]);
  ctx.stroke();
  ctx.setLineDash([]);
  if (group.length > MAX_DOTTED) return;
  ctx.font = "10px ui-monospace, 'DejaVu Sans Mono', monospace";
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  for (const i of group) {
    scenario?.vehicles[i]?.via.forEach((visit, k) => {
      const { min, max } = visit.box;
      const px = camera.px((num(min, 0) + num(max, 0)) / 2);
      const py = camera.py((num(min, 1) + num(max, 1)) / 2);
      if (isNear(camera, px, py)) ctx.fillText(String(k + 1), px, py);
    });
  }
}

/** A box, at least as large as can be seen. */
function addBox(ctx: CanvasRenderingContext2D, camera: Camera, { box }: GoalView): void {
  const px = camera.px((num(box.min, 0) + num(box.max, 0)) / 2);
  const py = camera.py((num(box.min, 1) + num(box.max, 1)) / 2);
  const width = Math.max((num(box.max, 0) - num(box.min, 0)) * camera.scale, 6);
  const height = Math.max((num(box.max, 1) - num(box.min, 1)) * camera.scale, 6);
  if (px + width < 0 || px - width > camera.width || py + height < 0 || py - height > camera.height) return;
  ctx.rect(px - width / 2, py - height / 2, width, height);
}

function isNear(camera: Camera, px: number, py: number): boolean {
  return px > -20 && py > -20 && px < camera.width + 20 && py < camera.height + 20;
}

export const drawTracks: Layer = (ctx, frame) => {
  const { plan, camera, switches, vehicleColors } = frame;
  if (plan === null || !switches.tracks) return;
  const { paths, bounds, perStep } = tracksOf(plan);
  ctx.lineJoin = "round";
  ctx.lineWidth = paths.length > 200 ? 1 : 1.5;
  ctx.globalAlpha = frame.isStale ? 0.4 : 1;
  if (frame.isStale) ctx.setLineDash([5, 4]);
  for (const [color, group] of byColor(vehicleColors)) {
    ctx.strokeStyle = color;
    ctx.beginPath();
    for (const i of group) {
      const path = paths[i];
      const around = bounds[i];
      if (path !== undefined && around !== undefined && isInSight(camera, around)) addPath(ctx, camera, path);
    }
    ctx.stroke();
  }
  ctx.setLineDash([]);
  if (paths.length <= MAX_DOTTED) dotSteps(ctx, frame, paths, perStep);
  ctx.globalAlpha = 1;
};

export function isInSight(camera: Camera, bounds: Bounds): boolean {
  return (
    camera.px(bounds.maxX) >= 0 && camera.px(bounds.minX) <= camera.width &&
    camera.py(bounds.minY) >= 0 && camera.py(bounds.maxY) <= camera.height
  );
}

/** Adds a track to the path, without the detail that cannot be seen. */
export function addPath(ctx: CanvasRenderingContext2D, camera: Camera, path: Float64Array): void {
  let lastX = Infinity;
  let lastY = Infinity;
  const end = path.length - 2;
  for (let i = 0; i <= end; i += 2) {
    const px = camera.px(num(path, i));
    const py = camera.py(num(path, i + 1));
    if (i === 0) {
      ctx.moveTo(px, py);
    } else {
      if (i < end && Math.abs(px - lastX) + Math.abs(py - lastY) < DETAIL) continue;
      ctx.lineTo(px, py);
    }
    lastX = px;
    lastY = py;
  }
}

function dotSteps(ctx: CanvasRenderingContext2D, frame: Frame, paths: readonly Float64Array[], perStep: number): void {
  const { camera } = frame;
  for (const [color, group] of byColor(frame.vehicleColors)) {
    ctx.fillStyle = color;
    ctx.beginPath();
    for (const i of group) {
      const path = paths[i];
      if (path === undefined) continue;
      let lastX = Infinity;
      let lastY = Infinity;
      for (let k = 2 * perStep; k < path.length; k += 2 * perStep) {
        const px = camera.px(num(path, k));
        const py = camera.py(num(path, k + 1));
        if (Math.abs(px - lastX) + Math.abs(py - lastY) < 8 || !isNear(camera, px, py)) continue;
        ctx.moveTo(px + 2, py);
        ctx.arc(px, py, 2, 0, TAU);
        lastX = px;
        lastY = py;
      }
    }
    ctx.fill();
  }
}
