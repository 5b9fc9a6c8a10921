/** What the view in space is told: what the map's layers are, less what is flat. */

import type { ObstacleView } from "../protocol";
import type { Frame } from "../scene/frame";

export type SpaceFrame = Pick<
  Frame,
  | "time"
  | "colors"
  | "vehicleColors"
  | "plan"
  | "compared"
  | "trails"
  | "flight"
  | "highlight"
  | "switches"
> & { readonly scenario: NonNullable<Frame["scenario"]> };

/** Three coordinates [m]. */
export type Point = readonly [number, number, number];

/** A place as three coordinates, whatever the list has. */
export function point(at: readonly number[]): Point {
  return [at[0] ?? 0, at[1] ?? 0, at[2] ?? 0];
}

/** How far a corner of an obstacle has moved at a time [steps], in m. */
export function displacement({ moving }: ObstacleView, corner: number, time: number): Point {
  if (moving === null || moving.length === 0) return [0, 0, 0];
  return placeAt(moving.map((step) => step[corner] ?? []), 1, time);
}

/** A place on a list of places of which there are `perStep` for each step. */
export function placeAt(path: readonly (readonly number[])[], perStep: number, time: number): Point {
  const at = Math.min(Math.max(time * perStep, 0), Math.max(path.length - 1, 0));
  const low = Math.floor(at);
  const before = point(path[low] ?? []);
  const after = point(path[low + 1] ?? path[low] ?? []);
  const part = at - low;
  return [
    before[0] + part * (after[0] - before[0]),
    before[1] + part * (after[1] - before[1]),
    before[2] + part * (after[2] - before[2]),
  ];
}
