/** Vehicles at the time shown: hulls, discs of the stated level. */

import type { Frame, Layer } from "../frame";
import { vehicleAt } from "../../edit/things";
import { ellipseAt, num, placeAt, tracksOf } from "../geometry";
import type { Thing } from "../../state/selection";
import { byColor } from "./tracks";

const TAU = 2 * Math.PI;

const ellipse = new Float64Array(3);
let places = new Float64Array(0);

/** Pixels of each vehicle at the time of the frame; x is NaN where it is out of sight. */
export function vehiclePixels(frame: Frame): Float64Array {
  const { camera, plan, scenario, time } = frame;
  const count = frame.vehicleColors.length;
  if (places.length < 2 * count) places = new Float64Array(2 * count);
  const tracks = plan === null ? null : tracksOf(plan);
  for (let i = 0; i < count; i += 1) {
    const path = tracks?.paths[i];
    if (tracks !== null && path !== undefined) {
      placeAt(path, tracks.perStep, time, places, 2 * i);
    } else {
      const start = scenario?.vehicles[i]?.start;
      places[2 * i] = start?.[0] ?? NaN;
      places[2 * i + 1] = start?.[1] ?? NaN;
    }
    const px = camera.px(num(places, 2 * i));
    const py = camera.py(num(places, 2 * i + 1));
    const isFar = px < -100 || py < -100 || px > camera.width + 100 || py > camera.height + 100;
    places[2 * i] = isFar ? NaN : px;
    places[2 * i + 1] = py;
  }
  return places;
}

/** How large a vehicle is drawn [px]. */
export function radiusOf(frame: Frame, i: number): number {
  const vehicles = frame.plan?.scenario.vehicles ?? frame.scenario?.vehicles;
  return (vehicles?.[i]?.radius ?? 0) * frame.camera.scale;
}

export const drawVehicles: Layer = (ctx, frame) => {
  const { switches, plan } = frame;
  const pixels = vehiclePixels(frame);
  ctx.lineWidth = 1;
  if (frame.isStale) ctx.globalAlpha = 0.5;
  for (const [color, group] of byColor(frame.vehicleColors)) {
    ctx.fillStyle = color;
    ctx.strokeStyle = color;
    if (switches.discs && plan !== null) drawDiscs(ctx, frame, group, pixels);
    if (switches.hulls) drawHulls(ctx, frame, group, pixels);
  }
  ctx.globalAlpha = 1;
};

function drawDiscs(
  ctx: CanvasRenderingContext2D, frame: Frame, group: readonly number[], pixels: Float64Array,
): void {
  const { plan, camera, time } = frame;
  if (plan === null) return;
  const { covariances } = tracksOf(plan);
  const scale = plan.sigmas * camera.scale;
  ctx.beginPath();
  for (const i of group) {
    const covariance = covariances[i];
    const px = num(pixels, 2 * i);
    if (covariance === undefined || Number.isNaN(px)) continue;
    const py = num(pixels, 2 * i + 1);
    ellipseAt(covariance, time, ellipse);
    const a = scale * num(ellipse, 0);
    if (a < 0.75) continue;
    const angle = -num(ellipse, 2);
    ctx.moveTo(px + a * Math.cos(angle), py + a * Math.sin(angle));
    ctx.ellipse(px, py, a, Math.max(scale * num(ellipse, 1), 0.3), angle, 0, TAU);
  }
  const before = ctx.globalAlpha;
  ctx.globalAlpha = 0.16 * before;
  ctx.fill();
  ctx.globalAlpha = 0.8 * before;
  ctx.stroke();
  ctx.globalAlpha = before;
}

function drawHulls(
  ctx: CanvasRenderingContext2D, frame: Frame, group: readonly number[], pixels: Float64Array,
): void {
  ctx.beginPath();
  for (const i of group) {
    const px = num(pixels, 2 * i);
    if (Number.isNaN(px)) continue;
    const py = num(pixels, 2 * i + 1);
    const radius = Math.max(radiusOf(frame, i), 2);
    ctx.moveTo(px + radius, py);
    ctx.arc(px, py, radius, 0, TAU);
  }
  const before = ctx.globalAlpha;
  ctx.globalAlpha = 0.5 * before;
  ctx.fill();
  ctx.globalAlpha = before;
  ctx.stroke();
}

/** Rings around vehicles that are selected, pointed at, or named by a panel. */
export const drawVehicleMarks: Layer = (ctx, frame) => {
  const { scenario, selected, hovered, highlight, colors } = frame;
  if (scenario === null || (selected === null && hovered === null && highlight === null)) return;
  const pixels = vehiclePixels(frame);
  ctx.strokeStyle = colors.accent;
  const drawn = frame.plan?.scenario.vehicles ?? scenario.vehicles;
  const selectedName = nameOf(frame, selected);
  const hoveredName = nameOf(frame, hovered);
  for (let i = 0; i < drawn.length; i += 1) {
    const name = drawn[i]?.name ?? "";
    const isMarked = name === selectedName || highlight?.vehicles.includes(name) === true;
    const px = num(pixels, 2 * i);
    if ((!isMarked && name !== hoveredName) || Number.isNaN(px)) continue;
    ctx.lineWidth = isMarked ? 2 : 1.25;
    ctx.beginPath();
    ctx.arc(px, num(pixels, 2 * i + 1), Math.max(radiusOf(frame, i), 3) + 3.5, 0, TAU);
    ctx.stroke();
  }
  for (const place of highlight?.at ?? []) {
    const [px, py] = frame.camera.toScreen(num(place, 0), num(place, 1));
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.arc(px, py, 9, 0, TAU);
    ctx.moveTo(px - 14, py);
    ctx.lineTo(px - 5, py);
    ctx.moveTo(px + 5, py);
    ctx.lineTo(px + 14, py);
    ctx.stroke();
  }
};

function nameOf({ scenario }: Frame, thing: Thing | null): string | null {
  return scenario === null || thing === null ? null : (vehicleAt(scenario, thing.path)?.name ?? null);
}
