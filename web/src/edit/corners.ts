/** Corners of outlines: added and taken away. */

import { change } from "../actions";
import type { DocumentState, Handle, Path } from "../protocol";
import { document, Held } from "../state/document";
import { samePath, selected, type Thing } from "../state/selection";
import { activeHandle, isWhole } from "./drag";
import { clean, get, isList } from "./paths";
import { handlesOf, nameOf } from "./things";

interface Corner {
  readonly thing: Thing;
  /** The list that holds it, and where in it. */
  readonly list: Path;
  readonly index: number;
}

/** The list of corners, and the place in it, that a handle moves; null for a box and the like. */
function cornerOf(thing: Thing, handle: Handle): Corner | null {
  const [path] = handle.x;
  if (thing.kind !== "obstacle" || path === undefined || isWhole(handle)) return null;
  const index = path.at(-2);
  return typeof index === "number" ? { thing, list: path.slice(0, -2), index } : null;
}

function chosen(): Corner | null {
  const view = document.peek()?.view;
  const thing = selected.peek();
  if (view == null || thing === null) return null;
  const handle = handlesOf(view, thing)[activeHandle.peek()];
  return handle === undefined ? null : cornerOf(thing, handle);
}

/** Take the chosen corner away; a polygon keeps three, a line two. */
export async function removeCorner(): Promise<void> {
  const corner = chosen();
  const state = document.peek();
  if (corner === null || state?.view == null) return;
  const list = get(state.content, corner.list);
  const least = corner.list.at(-1) === "line" ? 2 : 3;
  if (!isList(list) || list.length <= least) return;
  const path = [...corner.list, corner.index];
  if (await change([{ path }], `Remove a corner of ${nameOf(state.view, corner.thing)}`)) activeHandle.value = 0;
}

/** A corner half-way from the chosen one to the next. */
export async function insertCorner(): Promise<void> {
  const corner = chosen();
  if (corner !== null) await insertAfter(corner, null);
}

/** A corner at a place on an edge of the selected obstacle, within reach [m]. */
export async function insertAt(place: readonly [number, number], reach: number): Promise<void> {
  const view = document.peek()?.view;
  const thing = selected.peek();
  if (view == null || thing === null) return;
  const corners = handlesOf(view, thing).flatMap((handle) => cornerOf(thing, handle) ?? []);
  const content = document.peek()?.content;
  let best: Corner | null = null;
  let least = reach;
  for (const corner of corners) {
    const edge = edgeOf(get(content, corner.list), corner);
    const far = edge === null ? Infinity : distance(edge, place);
    if (far >= least) continue;
    best = corner;
    least = far;
  }
  if (best !== null) await insertAfter(best, place);
}

type Point = readonly [number, number];

/** From a corner to the next; a line ends with its last. */
function edgeOf(list: unknown, corner: Corner): readonly [Point, Point] | null {
  if (!Array.isArray(list)) return null;
  const from: unknown = list[corner.index];
  const isEnd = corner.index === list.length - 1;
  if (isEnd && corner.list.at(-1) === "line") return null;
  const to: unknown = list[isEnd ? 0 : corner.index + 1];
  return isPoint(from) && isPoint(to) ? [from, to] : null;
}

function isPoint(value: unknown): value is Point {
  return Array.isArray(value) && value.length === 2 && value.every((each) => typeof each === "number");
}

function distance([a, b]: readonly [Point, Point], [x, y]: Point): number {
  const dx = b[0] - a[0];
  const dy = b[1] - a[1];
  const length = dx * dx + dy * dy;
  const share = length === 0 ? 0 : Math.min(Math.max(((x - a[0]) * dx + (y - a[1]) * dy) / length, 0), 1);
  return Math.hypot(x - a[0] - share * dx, y - a[1] - share * dy);
}

async function insertAfter(corner: Corner, place: Point | null): Promise<void> {
  const before = document.peek()?.view;
  if (before == null) return;
  const held = new Held(corner.thing);
  const own = corner.list.slice(corner.thing.path.length);
  // Corners may be moved, and the obstacle, by changes that have not been answered yet.
  const make = ({ content }: DocumentState) => {
    if (held.thing === null) return null;
    const path = [...held.thing.path, ...own];
    const list = get(content, path);
    const edge = edgeOf(list, corner);
    if (!isList(list) || edge === null) return null;
    const [a, b] = edge;
    const made = place ?? [clean((a[0] + b[0]) / 2), clean((a[1] + b[1]) / 2)];
    return [{ path, value: [...list.slice(0, corner.index + 1), made, ...list.slice(corner.index + 1)] }];
  };
  if (!(await change(make, `Add a corner of ${nameOf(before, corner.thing)}`))) return;
  const view = document.peek()?.view;
  const { thing } = held;
  if (view == null || thing === null) return;
  const path = [...thing.path, ...own];
  const at = handlesOf(view, thing).findIndex((handle) => {
    const found = cornerOf(thing, handle);
    return found?.index === corner.index + 1 && samePath(found.list, path);
  });
  activeHandle.value = Math.max(at, 0);
}
