/** The things of a scenario: found by their paths, named, listed. */

import type { GoalView, Handle, ObstacleView, Path, Remark, ScenarioView, VehicleView } from "../protocol";
import { samePath, type Thing } from "../state/selection";
import { startsWith } from "./paths";

export function vehicleAt(scenario: ScenarioView, path: Path): VehicleView | null {
  return path[0] === "vehicles" ? entryAt(scenario.vehicles, path) : null;
}

export function obstacleAt(scenario: ScenarioView, path: Path): ObstacleView | null {
  return path[0] === "obstacles" ? entryAt(scenario.obstacles, path) : null;
}

/** A view may lack entries of the document: those that cannot be drawn. */
function entryAt<E extends { readonly path: Path }>(entries: readonly E[], path: Path): E | null {
  const isIt = (entry: E | undefined): entry is E => entry !== undefined && entry.path[1] === path[1];
  const at = entries[Number(path[1])];
  return isIt(at) ? at : (entries.find(isIt) ?? null);
}

/** A goal, or a place to visit. */
export function goalAt(scenario: ScenarioView, path: Path): GoalView | null {
  const vehicle = vehicleAt(scenario, path);
  if (vehicle === null || path.length < 3) return null;
  return [vehicle.goal, ...vehicle.via].find((goal) => samePath(goal.path, path)) ?? null;
}

/** What can be dragged of a thing: the whole of it first. */
export function handlesOf(scenario: ScenarioView, thing: Thing): readonly Handle[] {
  switch (thing.kind) {
    case "vehicle": {
      const handle = vehicleAt(scenario, thing.path)?.startHandle;
      return handle == null ? [] : [handle];
    }
    case "goal":
    case "waypoint":
      return goalAt(scenario, thing.path)?.handles ?? [];
    case "obstacle":
      return obstacleAt(scenario, thing.path)?.handles ?? [];
    case "workspace":
      return scenario.workspaceHandles;
  }
}

/** Whether the thing is still there. */
export function exists(scenario: ScenarioView, thing: Thing): boolean {
  switch (thing.kind) {
    case "vehicle":
      return vehicleAt(scenario, thing.path) !== null;
    case "goal":
    case "waypoint":
      return goalAt(scenario, thing.path) !== null;
    case "obstacle":
      return obstacleAt(scenario, thing.path) !== null;
    case "workspace":
      return scenario.workspace !== null;
  }
}

/** What a thing is called on the page. */
export function nameOf(scenario: ScenarioView, thing: Thing): string {
  const vehicle = vehicleAt(scenario, thing.path);
  switch (thing.kind) {
    case "vehicle":
      return vehicle?.name ?? "vehicle";
    case "goal":
      return `${vehicle?.name ?? ""}: goal`;
    case "waypoint":
      return `${vehicle?.name ?? ""}: waypoint ${Number(thing.path[3]) + 1}`;
    case "obstacle":
      return obstacleAt(scenario, thing.path)?.name ?? "obstacle";
    case "workspace":
      return "workspace";
  }
}

/** All things in the order of the list: vehicles with what is theirs, obstacles, the workspace. */
export function thingsOf(scenario: ScenarioView): readonly Thing[] {
  const things: Thing[] = [];
  for (const vehicle of scenario.vehicles) {
    things.push({ kind: "vehicle", path: vehicle.path }, { kind: "goal", path: vehicle.goal.path });
    for (const visit of vehicle.via) things.push({ kind: "waypoint", path: visit.path });
  }
  for (const obstacle of scenario.obstacles) things.push({ kind: "obstacle", path: obstacle.path });
  if (scenario.workspace !== null) things.push({ kind: "workspace", path: ["workspace"] });
  return things;
}

/** The thing that a place in the document belongs to; null is the scenario as a whole. */
export function thingAt(scenario: ScenarioView, path: Path): Thing | null {
  const vehicle = vehicleAt(scenario, path);
  if (vehicle !== null) {
    const visit = vehicle.via.find((candidate) => startsWith(path, candidate.path));
    if (visit !== undefined) return { kind: "waypoint", path: visit.path };
    if (startsWith(path, vehicle.goal.path)) return { kind: "goal", path: vehicle.goal.path };
    return { kind: "vehicle", path: vehicle.path };
  }
  const obstacle = obstacleAt(scenario, path);
  if (obstacle !== null) return { kind: "obstacle", path: obstacle.path };
  return path[0] === "workspace" && scenario.workspace !== null ? { kind: "workspace", path: ["workspace"] } : null;
}

/** Where on the map a thing is [m]. */
export function placeOf(scenario: ScenarioView, thing: Thing): readonly number[] | null {
  const [whole] = thing.kind === "workspace" ? [] : handlesOf(scenario, thing);
  if (whole !== undefined) return whole.at;
  if (thing.kind === "vehicle") return vehicleAt(scenario, thing.path)?.start ?? null;
  const box = thing.kind === "workspace" ? scenario.workspace : goalAt(scenario, thing.path)?.box;
  if (box != null) return box.min.map((least, axis) => (least + (box.max[axis] ?? 0)) / 2);
  const obstacle = obstacleAt(scenario, thing.path);
  return obstacle?.rings[0]?.[0] ?? obstacle?.corners[0] ?? null;
}

/** What is remarked on a thing, things within it included. */
export function remarksOn(remarks: readonly Remark[], path: Path): readonly Remark[] {
  return remarks.filter((remark) => startsWith(remark.path, path));
}

/** Where on the map a remark is shown: its own place, or that of its thing, or that of a vehicle. */
export function placeOfRemark(scenario: ScenarioView, remark: Remark): readonly number[] | null {
  if (remark.at !== null) return remark.at;
  const thing = thingAt(scenario, remark.path);
  if (thing !== null) return placeOf(scenario, thing);
  const [name] = remark.vehicles;
  return scenario.vehicles.find((vehicle) => vehicle.name === name)?.start ?? null;
}
