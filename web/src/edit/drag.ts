/** Handles dragged: shown at once on the page, then one change of the document. */

import { signal } from "@preact/signals";
import { change } from "../actions";
import type { Box, Change, DocumentState, GoalView, Handle, ObstacleView, Path, ScenarioView } from "../protocol";
import { document, type Echo, echoes, Held, withEchoes } from "../state/document";
import { samePath, type Thing } from "../state/selection";
import { clean, get, keyOf } from "./paths";
import { handlesOf, nameOf } from "./things";

/** Which of the selected thing's handles the keys move. */
export const activeHandle = signal(0);

/** Number of decimals of a place that a pixel can tell apart, at so many pixels per meter. */
export function decimals(scale: number): number {
  return Math.min(Math.max(Math.ceil(Math.log10(scale) - 0.3), 0), 6);
}

/** By how much a handle goes so that it ends on a round number [m]; the whole goes by a round step. */
export function rounded(handle: Handle, dx: number, dy: number, digits: number): [number, number] {
  const [x = 0, y = 0] = isWhole(handle) ? [0, 0] : handle.at;
  return [clean(round(x + dx, digits) - x), clean(round(y + dy, digits) - y)];
}

function round(value: number, digits: number): number {
  const factor = 10 ** digits;
  return Math.round(value * factor) / factor;
}

/** A handle on its way: shown moved at once, whatever else becomes of the document meanwhile. */
export class Drag {
  readonly index: number;
  readonly #held: Held;
  #by: readonly [dx: number, dy: number] = [0, 0];
  #echo: Echo | null = null;

  constructor(thing: Thing, index: number) {
    this.#held = new Held(thing);
    this.index = index;
  }

  /** As it is now; null once it is gone. */
  get thing(): Thing | null {
    return this.#held.thing;
  }

  /** By how much it goes [m]. */
  get by(): readonly [dx: number, dy: number] {
    return this.#by;
  }

  /** The handle where it would be without this; undefined once it is gone. */
  get handle(): Handle | undefined {
    const view = withEchoes(echoes.peek().filter((echo) => echo !== this.#echo));
    return view === null || this.thing === null ? undefined : handlesOf(view, this.thing)[this.index];
  }

  /** Show it moved by (dx, dy) [m]. */
  show(dx: number, dy: number): void {
    this.#by = [dx, dy];
    this.#put(false);
  }

  /** Show it where it was. */
  drop(): void {
    echoes.value = echoes.peek().filter((echo) => echo !== this.#echo);
    this.#echo = null;
  }

  /** Tell the server; what is shown stays until it answers. */
  async finish(): Promise<void> {
    const [dx, dy] = this.#by;
    const view = document.peek()?.view;
    if (view == null || this.thing === null || this.handle === undefined || (dx === 0 && dy === 0)) {
      this.drop();
      return;
    }
    this.#put(true);
    await change((state) => this.#changes(state), `Move ${nameOf(view, this.thing)}`);
    this.drop();
  }

  #put(isSent: boolean): void {
    const [dx, dy] = this.#by;
    const edit = (view: ScenarioView) => (this.thing === null ? view : moved(view, this.thing, this.index, dx, dy));
    const others = echoes.peek().filter((echo) => echo !== this.#echo);
    this.#echo = { edit, isSent };
    echoes.value = [...others, this.#echo];
  }

  #changes({ content, view }: DocumentState): readonly Change[] | null {
    const { thing, index } = this;
    const [dx, dy] = this.#by;
    const handle = view === null || thing === null ? undefined : handlesOf(view, thing)[index];
    if (view === null || thing === null || handle === undefined) return null;
    return (
      cornersInstead(content, view, thing, index, dx, dy) ?? [
        ...changesAlong(handle.x, dx, (path) => get(content, path)),
        ...changesAlong(handle.y, dy, (path) => get(content, path)),
      ]
    );
  }
}

/** Of what is described by half-spaces no number is a corner's: its corners take their place. */
export function cornersInstead(
  content: DocumentState["content"],
  view: ScenarioView,
  thing: Thing,
  index: number,
  dx: number,
  dy: number,
): readonly Change[] | null {
  const at = (key: string): Path => [...thing.path, key];
  if (thing.kind !== "obstacle" || get(content, at("normals")) === undefined) return null;
  const after = moved(view, thing, index, dx, dy).obstacles.find((one) => samePath(one.path, thing.path));
  const value = after?.rings[0]?.map((place) => place.map((each) => clean(each)));
  if (value === undefined) return null;
  return [{ path: at("normals") }, { path: at("offsets") }, { path: at("vertices"), value }];
}

function changesAlong(paths: readonly Path[], by: number, read: (path: Path) => unknown): readonly Change[] {
  if (by === 0) return [];
  return paths.flatMap((path) => {
    const value = read(path);
    return typeof value === "number" ? [{ path, value: clean(value + by) }] : [];
  });
}

/** A view with one handle moved, and with it all that hangs on the same numbers. */
export function moved(view: ScenarioView, thing: Thing, index: number, dx: number, dy: number): ScenarioView {
  const handle = handlesOf(view, thing)[index];
  if (handle === undefined) return view;
  const shift = shifter(handle, dx, dy);
  switch (thing.kind) {
    case "vehicle":
      return withVehicle(view, thing.path, (vehicle) => ({
        ...vehicle, start: shift(handle).at, startHandle: shift(handle),
      }));
    case "goal":
    case "waypoint":
      return withVehicle(view, thing.path, (vehicle) => ({
        ...vehicle,
        goal: samePath(vehicle.goal.path, thing.path) ? movedGoal(vehicle.goal, shift) : vehicle.goal,
        via: vehicle.via.map((visit) => (samePath(visit.path, thing.path) ? movedGoal(visit, shift) : visit)),
      }));
    case "obstacle":
      return {
        ...view,
        obstacles: view.obstacles.map((obstacle) =>
          samePath(obstacle.path, thing.path) ? movedObstacle(obstacle, handle, dx, dy, shift) : obstacle,
        ),
      };
    case "workspace": {
      const handles = view.workspaceHandles.map(shift);
      const workspace = view.workspace === null ? null : movedBox(view.workspace, view.workspaceHandles, handles);
      return { ...view, workspace, workspaceHandles: handles };
    }
  }
}

type Shift = (handle: Handle) => Handle;

/** Moves handles as far as they hang on the numbers that the dragged one changes. */
function shifter(dragged: Handle, dx: number, dy: number): Shift {
  const xs = new Set(dragged.x.map(keyOf));
  const ys = new Set(dragged.y.map(keyOf));
  return (handle) => {
    const hangsX = handle.x.length > 0 && handle.x.some((path) => xs.has(keyOf(path)));
    const hangsY = handle.y.length > 0 && handle.y.some((path) => ys.has(keyOf(path)));
    if (!hangsX && !hangsY) return handle;
    // The whole of a box goes half as far as its corner.
    const shareX = hangsX ? handle.x.filter((path) => xs.has(keyOf(path))).length / handle.x.length : 0;
    const shareY = hangsY ? handle.y.filter((path) => ys.has(keyOf(path))).length / handle.y.length : 0;
    const [x = 0, y = 0, ...rest] = handle.at;
    return { ...handle, at: [x + shareX * dx, y + shareY * dy, ...rest] };
  };
}

function withVehicle(
  view: ScenarioView,
  path: Path,
  edit: (vehicle: ScenarioView["vehicles"][number]) => ScenarioView["vehicles"][number],
): ScenarioView {
  return { ...view, vehicles: view.vehicles.map((vehicle) => (vehicle.path[1] === path[1] ? edit(vehicle) : vehicle)) };
}

function movedGoal(goal: GoalView, shift: Shift): GoalView {
  const handles = goal.handles.map(shift);
  return { ...goal, handles, box: movedBox(goal.box, goal.handles, handles) };
}

/** A box whose sides go with the corners on them; with one handle, all of it goes. */
function movedBox(box: Box, before: readonly Handle[], after: readonly Handle[]): Box {
  const side = (value: number, axis: number): number => {
    const at =
      before.length === 1
        ? 0
        : before.findIndex((handle) => !isWhole(handle) && near(handle.at[axis] ?? NaN, value));
    const from = before[at]?.at[axis];
    const to = after[at]?.at[axis];
    return from === undefined || to === undefined ? value : value + to - from;
  };
  const min = box.min.map(side);
  const max = box.max.map(side);
  return {
    min: min.map((value, axis) => Math.min(value, max[axis] ?? value)),
    max: max.map((value, axis) => Math.max(value, min[axis] ?? value)),
  };
}

/** Whether a handle moves more than a corner. */
export function isWhole(handle: Handle): boolean {
  return handle.x.length > 1 || handle.y.length > 1;
}

/** Places are told rounded to what a screen shows. */
function near(one: number, other: number): boolean {
  return Math.abs(one - other) <= 1e-3 * Math.max(1, Math.abs(one));
}

function movedObstacle(obstacle: ObstacleView, dragged: Handle, dx: number, dy: number, shift: Shift): ObstacleView {
  const handles = obstacle.handles.map(shift);
  const isAll = dragged === obstacle.handles[0];
  const targets = new Map(
    obstacle.handles.flatMap((handle, i) => (isWhole(handle) ? [] : [[corner(handle.at), handles[i]?.at] as const])),
  );
  const place = (at: readonly number[]): [number, number] => {
    const [x = 0, y = 0] = at;
    if (isAll) return [x + dx, y + dy];
    const [tx = x, ty = y] = targets.get(corner(at)) ?? [];
    return [tx, ty];
  };
  return {
    ...obstacle,
    handles,
    rings: obstacle.rings.map((ring) => ring.map(place)),
    corners: obstacle.corners.map((at) => [...place(at), ...at.slice(2)]),
  };
}

/** Corners and handles are told with the same rounding. */
function corner(at: readonly number[]): string {
  return `${at[0] ?? 0} ${at[1] ?? 0}`;
}
