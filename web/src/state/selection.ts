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

export function samePath(one: Path, other: Path): boolean {
  return one.length === other.length && one.every((key, i) => key === other[i]);
}

export function sameThing(one: Thing | null, other: Thing | null): boolean {
  return one === other || (one !== null && other !== null && samePath(one.path, other.path));
}
