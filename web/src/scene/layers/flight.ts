/** A flight: where vehicles were measured, against where the plan has them. */

import { placeAt } from "../../panels/difference";
import { tickAt } from "../../panels/account";
import type { FlightState, TickView } from "../../protocol";
import type { Frame, Layer } from "../frame";

export const drawFlight: Layer = (ctx, frame) => {
  const { flight, plan, switches } = frame;
  if (flight === null || plan === null || !switches.flight) return;
  const tick = tickAt(flight, frame.time);
  if (tick === null) return;
  drawFlown(ctx, frame, flight, tick);
  drawReplans(ctx, frame, flight, tick);
  drawMeasured(ctx, frame, flight, tick);
};

/** Ways flown so far. */
function drawFlown(ctx: CanvasRenderingContext2D, frame: Frame, flight: FlightState, until: TickView): void {
  const { camera, colors } = frame;
  const flown = flight.ticks.filter((tick) => tick.step <= until.step);
  ctx.lineJoin = "round";
  ctx.lineWidth = 2.5;
  for (const i of until.states.keys()) {
    ctx.beginPath();
    for (const [k, tick] of flown.entries()) {
      const [x, y] = tick.states[i] ?? [];
      if (x === undefined || y === undefined) continue;
      if (k === 0) ctx.moveTo(camera.px(x), camera.py(y));
      else ctx.lineTo(camera.px(x), camera.py(y));
    }
    ctx.strokeStyle = frame.vehicleColors[i] ?? colors.muted;
    ctx.stroke();
  }
}

/** A diamond where each vehicle was when another plan was taken. */
function drawReplans(ctx: CanvasRenderingContext2D, frame: Frame, flight: FlightState, until: TickView): void {
  const { camera, colors } = frame;
  ctx.beginPath();
  for (const tick of flight.ticks) {
    if (!tick.isReplan || tick.step > until.step) continue;
    for (const [x, y] of tick.states) {
      if (x === undefined || y === undefined) continue;
      const px = camera.px(x);
      const py = camera.py(y);
      ctx.moveTo(px, py - 4);
      ctx.lineTo(px + 4, py);
      ctx.lineTo(px, py + 4);
      ctx.lineTo(px - 4, py);
      ctx.closePath();
    }
  }
  ctx.fillStyle = colors.ground;
  ctx.fill();
  ctx.strokeStyle = colors.text;
  ctx.lineWidth = 1;
  ctx.stroke();
}

/** Where vehicles were measured last, and how far that is from the plan that was begun with. */
function drawMeasured(ctx: CanvasRenderingContext2D, frame: Frame, flight: FlightState, tick: TickView): void {
  const { camera, colors, plan } = frame;
  if (plan === null) return;
  for (const [i, [x, y]] of tick.states.entries()) {
    if (x === undefined || y === undefined) continue;
    const color = frame.vehicleColors[i] ?? colors.muted;
    const px = camera.px(x);
    const py = camera.py(y);
    const track = plan.tracks[i];
    const mean = track !== undefined && flight.plan === plan.plan ? placeAt(track, tick.step * plan.perStep) : null;
    const [meanX, meanY] = mean ?? [];
    if (meanX !== undefined && meanY !== undefined) {
      ctx.beginPath();
      ctx.moveTo(camera.px(meanX), camera.py(meanY));
      ctx.lineTo(px, py);
      ctx.strokeStyle = colors.text;
      ctx.lineWidth = 1;
      ctx.stroke();
    }
    const radius = Math.max((plan.scenario.vehicles[i]?.radius ?? 0) * camera.scale, 3);
    ctx.beginPath();
    ctx.arc(px, py, radius, 0, 2 * Math.PI);
    ctx.strokeStyle = color;
    ctx.lineWidth = 2;
    ctx.stroke();
    ctx.beginPath();
    ctx.arc(px, py, 2.5, 0, 2 * Math.PI);
    ctx.fillStyle = color;
    ctx.fill();
  }
}
