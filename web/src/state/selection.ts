/** What is selected and what is pointed at. */

import { signal } from "@preact/signals";
import type { Path } from "../protocol";

/** A thing of the document, by its path. */
export interface Thing {
  readonly kind: "vehicle" | "obstacle" | "waypoint" | "goal" | "workspace";
  readonly path: Path;
}

export const selected = signal<Thing | null>(null);

export const hovered = signal<Thing | null>(null);

/** What a panel points at on the map: vehicles, and places [m]. */
export interface Highlight {
  readonly vehicles: readonly string[];
  readonly obstacles: readonly string[];
  readonly at: readonly (readonly number[])[];
}

export const highlight = signal<Highlight | null>(null);

const turns = new WeakMap<Thing, number>();
let last = 0;

/** A number of a thing that stays when its place in the document changes. */
export function turnOf(thing: Thing): number {
  const known = turns.get(thing);
  if (known !== undefined) return known;
  last += 1;
  turns.set(thing, last);
  return last;
}

/** The same thing at its place in a changed document; null where it has none. */
export function moved(thing: Thing, path: Path | null): Thing | null {
  if (path === null || samePath(thing.path, path)) return path === null ? null : thing;
  const now = { ...thing, path };
  turns.set(now, turnOf(thing));
  return now;
}

export function samePath(one: Path, other: Path): boolean {
  return one.length === other.length && one.every((key, i) => key === other[i]);
}

export function sameThing(one: Thing | null, other: Thing | null): boolean {
  return one === other || (one !== null && other !== null && samePath(one.path, other.path));
}
