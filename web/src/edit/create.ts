/** New things, as changes of the document. */

import { change } from "../actions";
import type { Change, Document, DocumentState, Json, Path } from "../protocol";
import { document, Held } from "../state/document";
import { activeHandle } from "./drag";
import { clean, get, isList, isMapping } from "./paths";
import { selected, type Thing } from "../state/selection";
import { nameOf } from "./things";

/** What a first vehicle is given where neither `defaults` nor another vehicle says. */
const FIRST: { readonly [key: string]: Json } = {
  radius: 0.4,
  control_limit: 1.5,
  speed_limit: 3,
  initial_covariance: [0.001, 0.001, 0.0001, 0.0001],
  disturbance_covariance: [0.001, 0.001, 0.0001, 0.0001],
};

/** Half width of a new goal or waypoint [m], where no other shows what is usual here. */
const HALF_WIDTH = 0.3;

type Point = readonly [number, number];

/** A vehicle from a start to a goal [m]. */
export async function addVehicle(start: Point, goal: Point): Promise<void> {
  let index = 0;
  const make = ({ content }: DocumentState) => {
    index = listOf(content, "vehicles").length;
    return withVehicle(content, start, goal);
  };
  if (await change(make, "Add a vehicle")) pick({ kind: "vehicle", path: ["vehicles", index] });
}

function withVehicle(content: Document, start: Point, goal: Point): readonly Change[] {
  const vehicles = listOf(content, "vehicles");
  const defaults = content["defaults"];
  const last = vehicles.at(-1);
  const missing = Object.entries(FIRST).filter(
    ([key]) => get(defaults, [key]) === undefined && !(key === "speed_limit" && vehicles.length > 0),
  );
  const own = missing.map(([key, value]): [string, Json] => [key, get(last, [key]) ?? value]);
  const vehicle: Json = {
    name: freeName(vehicles, "vehicle"),
    ...(vehicles.length > 0 ? Object.fromEntries(own.filter(([key]) => isNeeded(key, last))) : {}),
    start: fill(start, content),
    goal: { center: fill(goal, content), half_width: usualHalfWidth(vehicles) },
  };
  const changes: Change[] = [appended(content, "vehicles", vehicle)];
  // A first vehicle's properties are the defaults of those to come.
  if (vehicles.length === 0) {
    for (const [key, value] of own) changes.push({ path: ["defaults", key], value });
    if (!isMapping(defaults)) changes.splice(1, own.length, { path: ["defaults"], value: Object.fromEntries(own) });
  }
  return changes;
}

function isNeeded(key: string, last: Json | undefined): boolean {
  return key === "radius" || key === "control_limit" || get(last, [key]) !== undefined;
}

/** In space, places drawn from above are half-way up the workspace. */
function fill(point: Point, content: Document): readonly number[] {
  const [x, y] = point;
  const low = get(content, ["workspace", "min", 2]);
  const high = get(content, ["workspace", "max", 2]);
  const start = get(content, ["vehicles", 0, "goal", "center", 2]);
  if (typeof low === "number" && typeof high === "number") return [x, y, clean((low + high) / 2)];
  return typeof start === "number" ? [x, y, start] : [x, y];
}

function usualHalfWidth(vehicles: readonly Json[]): Json {
  return get(vehicles.at(-1), ["goal", "half_width"]) ?? HALF_WIDTH;
}

/** A place to visit, after those that the vehicle visits already: the one that a thing belongs to. */
export async function addWaypoint(thing: Thing, at: Point): Promise<void> {
  const vehicle = new Held({ kind: "vehicle", path: thing.path.slice(0, 2) });
  let place: Path = [];
  const make = ({ content }: DocumentState) => {
    if (vehicle.thing === null) return null;
    const path: Path = [...vehicle.thing.path, "via"];
    const via = get(content, path);
    const inherited = get(content, ["defaults", "via"]);
    const list = isList(via) ? via : isList(inherited) ? inherited : [];
    const visit: Json = { center: fill(at, content), half_width: usualHalfWidth(listOf(content, "vehicles")) };
    place = [...path, list.length];
    return [isList(via) ? { path: place, value: visit } : { path, value: [...list, visit] }];
  };
  if (await change(make, "Add a waypoint")) pick({ kind: "waypoint", path: place });
}

/** An obstacle through the points drawn. */
export async function addObstacle(kind: "polygon" | "box" | "line", points: readonly Point[]): Promise<void> {
  let index = 0;
  const make = ({ content }: DocumentState) => {
    const obstacles = listOf(content, "obstacles");
    const name = freeName(obstacles, kind === "line" ? "wall" : "obstacle");
    index = obstacles.length;
    return [appended(content, "obstacles", { name, ...described(kind, points, content) })];
  };
  if (await change(make, "Add an obstacle")) pick({ kind: "obstacle", path: ["obstacles", index] });
}

function described(
  kind: "polygon" | "box" | "line",
  points: readonly Point[],
  content: Document,
): { readonly [key: string]: Json } {
  const low = get(content, ["workspace", "min", 2]);
  const high = get(content, ["workspace", "max", 2]);
  const isSpace = typeof low === "number" && typeof high === "number";
  if (kind === "box" || (isSpace && kind === "line")) {
    const min = [0, 1].map((axis) => Math.min(...points.map((point) => point[axis] ?? 0)));
    const max = [0, 1].map((axis) => Math.max(...points.map((point) => point[axis] ?? 0)));
    return isSpace ? { min: [...min, low], max: [...max, high] } : { min, max };
  }
  if (isSpace) return { vertices: [low, high].flatMap((z) => points.map((point) => [...point, z])) };
  return { [kind === "line" ? "line" : "vertices"]: points };
}

/** The workspace around all there is, where there is none. */
export async function addWorkspace(): Promise<void> {
  const state = document.peek();
  const extent = state?.view?.extent;
  if (extent === undefined) return;
  const value = { min: extent.min.map(Math.floor), max: extent.max.map(Math.ceil) };
  if (await change([{ path: ["workspace"], value }], "Add a workspace")) pick({ kind: "workspace", path: ["workspace"] });
}

/** Take a thing away; a goal cannot be. */
export async function remove(thing: Thing): Promise<void> {
  const view = document.peek()?.view;
  if (view == null || thing.kind === "goal") return;
  const held = new Held(thing);
  const make = ({ content }: DocumentState) => {
    if (held.thing === null) return null;
    const { path } = held.thing;
    const list = get(content, path.slice(0, -1));
    const isLast = thing.kind === "waypoint" && isList(list) && list.length === 1;
    return [{ path: isLast ? path.slice(0, -1) : path }];
  };
  // At once: the second of two quick clicks would remove what comes to be at its place.
  if (selected.peek() === thing) pick(null);
  const isDone = await change(make, `Remove ${nameOf(view, thing)}`);
  if (!isDone && selected.peek() === null) pick(held.thing);
}

/** Select a thing. */
export function pick(thing: Thing | null): void {
  selected.value = thing;
  activeHandle.value = 0;
}

function appended(content: Document, key: string, value: Json): Change {
  const list = content[key];
  return isList(list) ? { path: [key, list.length], value } : { path: [key], value: [value] };
}

function listOf(content: Document, key: string): readonly Json[] {
  const list = content[key];
  return isList(list) ? list : [];
}

function freeName(list: readonly Json[], stem: string): string {
  const taken = new Set(list.map((value) => get(value, ["name"])));
  for (let i = list.length + 1; ; i += 1) {
    if (!taken.has(`${stem} ${i}`)) return `${stem} ${i}`;
  }
}
