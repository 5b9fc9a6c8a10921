/** Pairs that keep in range of each other: a line between them, in alarm where they have lost it. */

import type { Frame, Layer } from "../frame";
import { num } from "../geometry";
import { vehiclePixels } from "./vehicles";

export const drawRanges: Layer = (ctx, frame) => {
  const scenario = frame.plan?.scenario ?? frame.scenario;
  if (scenario === null || scenario.ranges.length === 0) return;
  const pixels = vehiclePixels(frame);
  const names = scenario.vehicles.map(({ name }) => name);
  ctx.setLineDash([2, 4]);
  for (const { vehicles, within } of scenario.ranges) {
    const [a, b] = vehicles.map((name) => 2 * names.indexOf(name));
    if (a === undefined || b === undefined || a < 0 || b < 0) continue;
    drawRange(ctx, frame, [num(pixels, a), num(pixels, a + 1)], [num(pixels, b), num(pixels, b + 1)], within);
  }
  ctx.setLineDash([]);
};

type Pixel = readonly [number, number];

function drawRange(ctx: CanvasRenderingContext2D, { camera, colors, switches }: Frame, [ax, ay]: Pixel, [bx, by]: Pixel, within: number): void {
  const length = Math.hypot(bx - ax, by - ay);
  if (Number.isNaN(length)) return;
  const distance = length / camera.scale;
  ctx.strokeStyle = distance <= within ? colors.muted : colors.alert;
  ctx.lineWidth = 1.25;
  ctx.beginPath();
  ctx.moveTo(ax, ay);
  ctx.lineTo(bx, by);
  ctx.stroke();
  if (!switches.names || length < 60) return;
  ctx.font = "11px system-ui, 'Noto Sans', 'Liberation Sans', sans-serif";
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  ctx.lineJoin = "round";
  ctx.fillStyle = ctx.strokeStyle;
  const text = `${distance.toFixed(1)} of ${Number(within.toPrecision(4))} m`;
  ctx.setLineDash([]);
  ctx.strokeStyle = colors.ground;
  ctx.lineWidth = 3;
  ctx.strokeText(text, (ax + bx) / 2, (ay + by) / 2);
  ctx.fillText(text, (ax + bx) / 2, (ay + by) / 2);
  ctx.setLineDash([2, 4]);
}
