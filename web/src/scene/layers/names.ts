/** Names and other texts, above all else and beside each other. */

import type { ObstacleView } from "../../protocol";
import type { Camera } from "../camera";
import type { Frame, Layer } from "../frame";
import { isInside, num, shapeOf } from "../geometry";
import { around, insideFirst, shortened, type Spot, Taken } from "../placing";
import { rangeColor, rangesOf } from "./ranges";
import { radiusOf, vehiclePixels } from "./vehicles";

/** Number of names in sight up to which all are written; of more, those for which there is room. */
const MAX_NAMES = 40;

/** Room on the map that each of many has at least: less, and names would cover it [px²]. */
const ROOM = 4000;

/** Part of the map's width that a vehicle's name takes at most: so it fits on one of its sides. */
const WIDEST = 0.4;

const HIGH = 12; // of a text [px]
const SHORT = 60; // of a line between two without a text [px]

const ALONG = [0.5, 0.35, 0.65, 0.2, 0.8]; // parts of a line, where its text may stand
const INSIDE = [[0, 0], [0, 0.3], [0, -0.3], [-0.25, 0], [0.25, 0]] as const; // of an outline

export const drawNames: Layer = (ctx, frame) => {
  if (!frame.switches.names) return;
  ctx.font = "11px system-ui, 'Noto Sans', 'Liberation Sans', sans-serif";
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.lineJoin = "round";
  ctx.lineWidth = 3;
  ctx.strokeStyle = frame.colors.ground;
  const taken = new Taken();
  const pixels = vehiclePixels(frame);
  nameVehicles(ctx, frame, pixels, taken);
  for (const range of rangesOf(frame)) {
    if (range.length < SHORT) continue;
    const text = `${range.distance.toFixed(1)} of ${Number(range.within.toPrecision(4))} m`;
    const width = ctx.measureText(text).width;
    const [[ax, ay], [bx, by]] = range.ends;
    const spots = ALONG.map((part) => centered(ax + part * (bx - ax), ay + part * (by - ay), width));
    ctx.fillStyle = rangeColor(range, frame);
    write(ctx, text, taken.claim(spots) ?? spots[0]);
  }
  ctx.fillStyle = frame.colors.muted;
  nameOutlines(ctx, frame, taken);
};

function nameVehicles(ctx: CanvasRenderingContext2D, frame: Frame, pixels: Float64Array, taken: Taken): void {
  const { scenario, plan, camera, colors } = frame;
  const named = plan?.scenario.vehicles ?? scenario?.vehicles ?? [];
  const seen: number[] = [];
  for (let i = 0; i < named.length; i += 1) {
    const [px, py] = [num(pixels, 2 * i), num(pixels, 2 * i + 1)];
    if (!(px > 0 && px < camera.width && py > 0 && py < camera.height)) continue;
    seen.push(i);
    const radius = Math.max(radiusOf(frame, i), 4);
    taken.add({ left: px - radius, top: py - radius, width: 2 * radius, height: 2 * radius });
  }
  if (seen.length > MAX_NAMES && seen.length * ROOM > camera.width * camera.height) return;
  ctx.fillStyle = colors.text;
  for (const i of seen) {
    const text = shortened(named[i]?.name ?? "", (name) => ctx.measureText(name).width <= WIDEST * camera.width);
    const radius = Math.max(radiusOf(frame, i), 4);
    const beside = around(num(pixels, 2 * i), num(pixels, 2 * i + 1), radius, ctx.measureText(text).width, HIGH);
    const spots = insideFirst(beside, camera);
    const spot = taken.claim(spots) ?? (seen.length <= MAX_NAMES ? spots[0] : undefined);
    write(ctx, text, spot);
  }
}

/** Names obstacles, and says of those for some whom they stand in the way of, where there is room for it. */
function nameOutlines(ctx: CanvasRenderingContext2D, { scenario, camera }: Frame, taken: Taken): void {
  for (const obstacle of scenario?.obstacles ?? []) {
    const { bounds } = shapeOf(obstacle);
    // Too small for any name, which need not be measured then.
    if (obstacle.moving !== null || (bounds.maxX - bounds.minX) * camera.scale < HIGH) continue;
    const text = obstacle.only ?? obstacle.name;
    write(ctx, text, taken.claim(outlineSpots(obstacle, camera, ctx.measureText(text).width)) ?? undefined);
  }
}

/** Places for an obstacle's name of some width [px]: on what it names, though a shape may have its middle outside. */
export function outlineSpots(obstacle: ObstacleView, camera: Pick<Camera, "px" | "py" | "scale">, width: number): readonly Spot[] {
  const shape = shapeOf(obstacle);
  const [wide, high] = [shape.bounds.maxX - shape.bounds.minX, shape.bounds.maxY - shape.bounds.minY]; // [m]
  const isForSome = obstacle.only !== null;
  if (wide * camera.scale < (isForSome ? Math.max(50, 0.8 * width) : width)) return [];
  const places = INSIDE.map(([across, down]) => [shape.x + across * wide, shape.y - down * high] as const);
  const inside = places.filter(([x, y]) => isInside(shape, x, y));
  // Whom it is for must be seen, be it beside a line.
  return (inside.length > 0 || !isForSome ? inside : places).map(([x, y]) => centered(camera.px(x), camera.py(y), width));
}

function centered(px: number, py: number, width: number): Spot {
  return { left: px - width / 2, top: py - HIGH / 2, width, height: HIGH };
}

function write(ctx: CanvasRenderingContext2D, text: string, spot: Spot | undefined): void {
  if (spot === undefined) return;
  ctx.strokeText(text, spot.left, spot.top + HIGH / 2);
  ctx.fillText(text, spot.left, spot.top + HIGH / 2);
}
