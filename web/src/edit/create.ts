/** New things, as changes of the document. */

import { change } from "../actions";
import type { Change, Document, Json, Path } from "../protocol";
import { document } from "../state/document";
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
  const state = document.peek();
  if (state === null) return;
  const vehicles = listOf(state.content, "vehicles");
  const defaults = state.content["defaults"];
  const last = vehicles.at(-1);
  const missing = Object.entries(FIRST).filter(
    ([key]) => get(defaults, [key]) === undefined && !(key === "speed_limit" && vehicles.length > 0),
  );
  const own = missing.map(([key, value]): [string, Json] => [key, get(last, [key]) ?? value]);
  const vehicle: Json = {
    name: freeName(vehicles, "vehicle"),
    ...(vehicles.length > 0 ? Object.fromEntries(own.filter(([key]) => isNeeded(key, last))) : {}),
    start: fill(start, state.content),
    goal: { center: fill(goal, state.content), half_width: usualHalfWidth(vehicles) },
  };
  const changes: Change[] = [appended(state.content, "vehicles", vehicle)];
  // A first vehicle's properties are the defaults of those to come.
  if (vehicles.length === 0) {
    for (const [key, value] of own) changes.push({ path: ["defaults", key], value });
    if (!isMapping(defaults)) changes.splice(1, own.length, { path: ["defaults"], value: Object.fromEntries(own) });
  }
  if (await change(changes, "Add a vehicle")) pick({ kind: "vehicle", path: ["vehicles", vehicles.length] });
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

/** A place to visit, after those that the vehicle visits already. */
export async function addWaypoint(vehicle: number, at: Point): Promise<void> {
  const state = document.peek();
  if (state === null) return;
  const path: Path = ["vehicles", vehicle, "via"];
  const via = get(state.content, path);
  const inherited = get(state.content, ["defaults", "via"]);
  const list = isList(via) ? via : isList(inherited) ? inherited : [];
  const visit: Json = { center: fill(at, state.content), half_width: usualHalfWidth(listOf(state.content, "vehicles")) };
  const made = isList(via)
    ? { path: [...path, list.length], value: visit }
    : { path, value: [...list, visit] };
  if (await change([made], "Add a waypoint")) pick({ kind: "waypoint", path: [...path, list.length] });
}

/** An obstacle through the points drawn. */
export async function addObstacle(kind: "polygon" | "box" | "line", points: readonly Point[]): Promise<void> {
  const state = document.peek();
  if (state === null) return;
  const obstacles = listOf(state.content, "obstacles");
  const name = freeName(obstacles, kind === "line" ? "wall" : "obstacle");
  const value: Json = { name, ...described(kind, points, state.content) };
  const isDone = await change([appended(state.content, "obstacles", value)], "Add an obstacle");
  if (isDone) pick({ kind: "obstacle", path: ["obstacles", obstacles.length] });
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
  const path = thing.kind === "waypoint" && view.vehicles[Number(thing.path[1])]?.via.length === 1
    ? thing.path.slice(0, 3)
    : thing.path;
  if (await change([{ path }], `Remove ${nameOf(view, thing)}`)) pick(null);
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
