/** The plan that is compared with: dashed, its hulls at the same time, and where both are apart. */

import { placeAt } from "../../panels/difference";
import type { Frame, Layer } from "../frame";

export const drawCompared: Layer = (ctx, frame) => {
  const { plan, compared, camera, colors } = frame;
  if (plan === null || compared === null || plan.plan === compared.plan) return;
  const colorOf = new Map(plan.tracks.map((track, i) => [track.name, frame.vehicleColors[i]]));
  ctx.lineJoin = "round";
  ctx.lineWidth = 1.5;
  ctx.setLineDash([5, 4]);
  for (const track of compared.tracks) {
    ctx.strokeStyle = colorOf.get(track.name) ?? colors.muted;
    ctx.beginPath();
    for (const [i, [x, y]] of track.path.entries()) {
      if (x === undefined || y === undefined) continue;
      if (i === 0) ctx.moveTo(camera.px(x), camera.py(y));
      else ctx.lineTo(camera.px(x), camera.py(y));
    }
    ctx.stroke();
  }
  ctx.setLineDash([]);
};

/** Moves with time: outlines of the other plan's vehicles, and the distance that is pointed at. */
export const drawComparedNow: Layer = (ctx, frame) => {
  const { plan, compared, switches } = frame;
  if (plan === null || compared === null || plan.plan === compared.plan) return;
  if (switches.hulls) drawHulls(ctx, frame);
  drawApart(ctx, frame);
};

function drawHulls(ctx: CanvasRenderingContext2D, frame: Frame): void {
  const { plan, compared, camera, colors } = frame;
  if (plan === null || compared === null) return;
  const radii = new Map(compared.scenario.vehicles.map((vehicle) => [vehicle.name, vehicle.radius]));
  const seconds = frame.time * plan.scenario.dt;
  ctx.beginPath();
  for (const track of compared.tracks) {
    const [x, y] = placeAt(track, (seconds / compared.scenario.dt) * compared.perStep) ?? [];
    if (x === undefined || y === undefined) continue;
    const radius = Math.max((radii.get(track.name) ?? 0) * camera.scale, 2);
    ctx.moveTo(camera.px(x) + radius, camera.py(y));
    ctx.arc(camera.px(x), camera.py(y), radius, 0, 2 * Math.PI);
  }
  ctx.strokeStyle = colors.muted;
  ctx.lineWidth = 1.25;
  ctx.setLineDash([3, 3]);
  ctx.stroke();
  ctx.setLineDash([]);
}

/** A line between the two places that the panel points at. */
function drawApart(ctx: CanvasRenderingContext2D, { highlight, camera, colors }: Frame): void {
  const [here, there] = highlight?.at ?? [];
  if (here === undefined || there === undefined || highlight?.at.length !== 2) return;
  const [x0, y0] = here;
  const [x1, y1] = there;
  if (x0 === undefined || y0 === undefined || x1 === undefined || y1 === undefined) return;
  ctx.beginPath();
  ctx.moveTo(camera.px(x0), camera.py(y0));
  ctx.lineTo(camera.px(x1), camera.py(y1));
  ctx.strokeStyle = colors.text;
  ctx.lineWidth = 2;
  ctx.stroke();
  ctx.beginPath();
  ctx.arc(camera.px(x0), camera.py(y0), 3.5, 0, 2 * Math.PI);
  ctx.moveTo(camera.px(x1) + 3.5, camera.py(y1));
  ctx.arc(camera.px(x1), camera.py(y1), 3.5, 0, 2 * Math.PI);
  ctx.fillStyle = colors.text;
  ctx.fill();
}
