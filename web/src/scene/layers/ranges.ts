/** Pairs that keep in range of each other: a line between them, in alarm where they have lost it. */

import type { Frame, Layer } from "../frame";
import { num } from "../geometry";
import { vehiclePixels } from "./vehicles";

type Pixel = readonly [number, number];

/** A pair on the screen, at the time of the frame. */
export interface Range {
  readonly ends: readonly [Pixel, Pixel];
  /** On the screen [px]. */
  readonly length: number;
  /** Between the two, and the largest that is allowed [m]. */
  readonly distance: number;
  readonly within: number;
}

/** All pairs of which both are in sight. */
export function rangesOf(frame: Frame): readonly Range[] {
  const scenario = frame.plan?.scenario ?? frame.scenario;
  if (scenario === null || scenario.ranges.length === 0) return [];
  const pixels = vehiclePixels(frame);
  const names = scenario.vehicles.map(({ name }) => name);
  return scenario.ranges.flatMap(({ vehicles, within }) => {
    const [a, b] = vehicles.map((name) => 2 * names.indexOf(name));
    if (a === undefined || b === undefined || a < 0 || b < 0) return [];
    const [one, two]: [Pixel, Pixel] = [
      [num(pixels, a), num(pixels, a + 1)],
      [num(pixels, b), num(pixels, b + 1)],
    ];
    const length = Math.hypot(two[0] - one[0], two[1] - one[1]);
    if (Number.isNaN(length)) return [];
    return [{ ends: [one, two] as const, length, distance: length / frame.camera.scale, within }];
  });
}

export function rangeColor({ distance, within }: Range, { colors }: Frame): string {
  return distance <= within ? colors.muted : colors.alert;
}

export const drawRanges: Layer = (ctx, frame) => {
  ctx.setLineDash([2, 4]);
  ctx.lineWidth = 1.25;
  for (const range of rangesOf(frame)) {
    const [[ax, ay], [bx, by]] = range.ends;
    ctx.strokeStyle = rangeColor(range, frame);
    ctx.beginPath();
    ctx.moveTo(ax, ay);
    ctx.lineTo(bx, by);
    ctx.stroke();
  }
  ctx.setLineDash([]);
};
