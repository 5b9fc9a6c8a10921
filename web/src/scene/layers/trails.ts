/** Simulated missions as faint trails; those that collide are marked where they do. */

import type { Trail, TrailsView } from "../../protocol";
import type { Camera } from "../camera";
import type { Frame, Layer } from "../frame";

interface Drawn {
  /** Per vehicle: its trails in missions without a collision [m]. */
  readonly calm: readonly Path2D[];
  /** Trails of the vehicles that collide, until they do [m]. */
  readonly colliding: Path2D;
}

/** Kept by what they show: a mission has thousands of points. */
const known = new WeakMap<TrailsView, Drawn>();

export const drawTrails: Layer = (ctx, frame) => {
  const { trails, plan, switches, camera, vehicleColors, colors } = frame;
  if (trails === null || plan === null || !switches.trails || trails.plan !== plan.plan) return;
  const names = plan.tracks.map((track) => track.name);
  const { calm, colliding } = drawnOf(trails, names, plan.scenario.horizon * plan.scenario.dt);
  ctx.save();
  toMeters(ctx, camera);
  ctx.lineJoin = "round";
  ctx.lineWidth = 0.75 / camera.scale;
  ctx.globalAlpha = colors.isDark ? 0.35 : 0.28;
  for (const [i, path] of calm.entries()) {
    ctx.strokeStyle = vehicleColors[i] ?? colors.muted;
    ctx.stroke(path);
  }
  ctx.globalAlpha = 0.75;
  ctx.strokeStyle = colors.alert;
  ctx.stroke(colliding);
  ctx.restore();
  drawCollisions(ctx, frame, trails.trails);
};

/** From here on the context is in meters, y up. */
function toMeters(ctx: CanvasRenderingContext2D, camera: Camera): void {
  ctx.transform(camera.scale, 0, 0, -camera.scale, camera.px(0), camera.py(0));
}

/** Paths of trails; `seconds` is how long a mission takes. */
function drawnOf(trails: TrailsView, names: readonly string[], seconds: number): Drawn {
  const found = known.get(trails);
  if (found !== undefined) return found;
  const calm = names.map(() => new Path2D());
  const colliding = new Path2D();
  for (const trail of trails.trails) {
    for (const [i, path] of trail.paths.entries()) {
      const { collision } = trail;
      const isHit = collision?.names.includes(names[i] ?? "") ?? false;
      // What would come after a collision says nothing.
      const until = collision !== null && isHit ? collision.time / seconds : 1;
      add(isHit ? colliding : (calm[i] ?? colliding), path.slice(0, Math.ceil(until * (path.length - 1)) + 1));
    }
  }
  const made = { calm, colliding };
  known.set(trails, made);
  return made;
}

function add(path: Path2D, points: readonly (readonly number[])[]): void {
  for (const [i, [x, y]] of points.entries()) {
    if (x === undefined || y === undefined) continue;
    if (i === 0) path.moveTo(x, y);
    else path.lineTo(x, y);
  }
}

/** A cross at each collision. */
function drawCollisions(ctx: CanvasRenderingContext2D, frame: Frame, trails: readonly Trail[]): void {
  const { camera, colors } = frame;
  ctx.beginPath();
  for (const { collision } of trails) {
    const [x, y] = collision?.at ?? [];
    if (x === undefined || y === undefined) continue;
    const px = camera.px(x);
    const py = camera.py(y);
    ctx.moveTo(px - 5, py - 5);
    ctx.lineTo(px + 5, py + 5);
    ctx.moveTo(px + 5, py - 5);
    ctx.lineTo(px - 5, py + 5);
  }
  // A rim in the color of the ground keeps crosses apart from what is below.
  ctx.strokeStyle = colors.ground;
  ctx.lineWidth = 4;
  ctx.stroke();
  ctx.strokeStyle = colors.alert;
  ctx.lineWidth = 2;
  ctx.stroke();
}
