/** Where two plans differ: vehicle by vehicle, how far and when. */

import type { PlanView, TrackView } from "../protocol";

/** How far one vehicle's paths in two plans are apart, at most. */
export interface Difference {
  readonly name: string;
  /** Largest distance between both at the same time [m]. */
  readonly distance: number;
  /** When [s], and at which step of the first plan. */
  readonly time: number;
  readonly step: number;
  /** Where it is in either plan then [m]. */
  readonly here: readonly number[];
  readonly there: readonly number[];
}

/** Both plans' vehicles by name, those that differ most first; a vehicle in one of them is left out. */
export function differences(one: PlanView, other: PlanView): readonly Difference[] {
  const others = new Map(other.tracks.map((track) => [track.name, track]));
  const found: Difference[] = [];
  for (const track of one.tracks) {
    const match = others.get(track.name);
    if (match === undefined) continue;
    const difference = largest(track, one, match, other);
    if (difference !== null) found.push(difference);
  }
  return found.sort((a, b) => b.distance - a.distance);
}

function largest(track: TrackView, one: PlanView, match: TrackView, other: PlanView): Difference | null {
  let best: Difference | null = null;
  for (const [index, here] of track.path.entries()) {
    const time = (index / one.perStep) * one.scenario.dt;
    const there = placeAt(match, (time / other.scenario.dt) * other.perStep);
    if (there === null) continue;
    const distance = Math.hypot(...here.map((value, axis) => value - (there[axis] ?? value)));
    if (best === null || distance > best.distance + 1e-9) {
      best = { name: track.name, distance, time, step: index / one.perStep, here, there };
    }
  }
  return best;
}

/** Place on a path at a fractional index; null beside a path without places. */
export function placeAt(track: TrackView, index: number): readonly number[] | null {
  const last = track.path.length - 1;
  const low = Math.min(Math.max(Math.floor(index), 0), last);
  const from = track.path[low];
  if (from === undefined) return null;
  const to = track.path[Math.min(low + 1, last)] ?? from;
  const part = Math.min(Math.max(index - low, 0), 1);
  return from.map((value, axis) => value + ((to[axis] ?? value) - value) * part);
}
