/** Which fields a thing has, with labels and units, in the order in which they are shown. */

import type { Document, Json, Path } from "../protocol";
import type { Thing } from "../state/selection";
import { get, isList, isMapping } from "./paths";

export interface Cell {
  readonly path: Path;
  readonly kind: "number" | "text" | "json" | "choice";
  readonly label: string;
  readonly choices?: readonly string[];
}

/** A line of the property panel: one quantity, of one number or several. */
export interface Row {
  readonly label: string;
  readonly unit: string;
  readonly path: Path;
  readonly cells: readonly Cell[];
  /** What holds where nothing is stated. */
  readonly otherwise: Json | undefined;
  readonly isOptional: boolean;
}

export interface Group {
  readonly title: string;
  readonly rows: readonly Row[];
}

const AXES = ["x", "y", "z"];

/** Scalars of a vehicle: key, label, unit. */
const OF_VEHICLE: readonly (readonly [string, string, string])[] = [
  ["radius", "Radius", "m"],
  ["control_limit", "Control limit", "m/s²"],
  ["speed_limit", "Speed limit", "m/s"],
  ["initial_covariance", "Initial covariance", "m², m²/s²"],
  ["disturbance_covariance", "Disturbance covariance", "m², m²/s²"],
  ["cost_weight", "Cost weight", ""],
];

const SHOWN_OF_VEHICLE = new Set(["name", "start", "goal", "via", ...OF_VEHICLE.map(([key]) => key)]);

const SHOWN_OF_SCENARIO = new Set([
  "format", "name", "dt", "horizon", "risk_bound", "avoidance", "workspace", "obstacles", "vehicles", "defaults",
]);

/** Fields of the thing, or of the scenario where none is selected. */
export function fieldsOf(content: Document, thing: Thing | null): readonly Group[] {
  switch (thing?.kind) {
    case undefined:
      return ofScenario(content);
    case "vehicle":
      return ofVehicle(content, thing.path);
    case "goal":
    case "waypoint":
      return [{ title: thing.kind === "goal" ? "Goal" : "Waypoint", rows: ofBox(content, thing) }];
    case "obstacle":
      return [{ title: "Obstacle", rows: [name(thing.path), ...ofObstacle(content, thing.path)] }];
    case "workspace":
      return [{ title: "Workspace", rows: corners(content, thing.path) }];
  }
}

function ofScenario(content: Document): readonly Group[] {
  const rows = [
    name([]),
    number(["dt"], "Step", "s"),
    number(["horizon"], "Horizon", "steps"),
    number(["risk_bound"], "Risk bound Δ", ""),
    row(["avoidance"], "Avoidance", "", "choice", "intervals", ["intervals", "steps"]),
  ];
  const defaults = OF_VEHICLE.map(([key, label, unit]) => value(content, ["defaults", key], label, unit, undefined));
  return [
    { title: "Scenario", rows: [...rows, ...others(content, [], SHOWN_OF_SCENARIO)] },
    { title: "Defaults of vehicles", rows: [...defaults, ...others(content, ["defaults"], SHOWN_OF_VEHICLE)] },
  ];
}

function ofVehicle(content: Document, path: Path): readonly Group[] {
  const rows = OF_VEHICLE.map(([key, label, unit]) =>
    value(content, [...path, key], label, unit, get(content, ["defaults", key])),
  );
  return [
    { title: "Vehicle", rows: [name(path), ...ofStart(content, path), ...rows, ...others(content, path, SHOWN_OF_VEHICLE)] },
    { title: "Goal", rows: ofBox(content, { kind: "goal", path: [...path, "goal"] }) },
  ];
}

/** The place, and the velocity where the start is a full state. */
function ofStart(content: Document, path: Path): readonly Row[] {
  const start = get(content, [...path, "start"]);
  if (!isList(start)) return [value(content, [...path, "start"], "Start", "m", get(content, ["defaults", "start"]))];
  const isState = start.length >= 4;
  const d = isState ? Math.floor(start.length / 2) : start.length;
  const cells = start.map((_, i) => cell([...path, "start", i], AXES[i % d] ?? String(i)));
  const at = { label: "Start", unit: "m", path: [...path, "start"], otherwise: undefined, isOptional: false };
  const place = { ...at, cells: cells.slice(0, d) };
  return isState ? [place, { ...at, label: "Velocity", unit: "m/s", cells: cells.slice(d) }] : [place];
}

function ofBox(content: Document, thing: Thing): readonly Row[] {
  const { path } = thing;
  const inherited = thing.kind === "goal" && get(content, path) === undefined;
  if (inherited) return [value(content, path, "Goal", "", get(content, ["defaults", "goal"]))];
  const rows: Row[] =
    get(content, [...path, "center"]) === undefined
      ? [...corners(content, path)]
      : [
          ...coordinates(content, [...path, "center"], "Center"),
          value(content, [...path, "half_width"], "Half width", "m", 0),
        ];
  rows.push(value(content, [...path, "speed"], "Largest speed", "m/s", thing.kind === "goal" ? 0 : undefined));
  const key = thing.kind === "goal" ? "within" : "between";
  rows.push(value(content, [...path, key], thing.kind === "goal" ? "Arrives within" : "Between", "steps", undefined));
  return [...rows, ...others(content, path, new Set(["center", "half_width", "min", "max", "speed", key]))];
}

function ofObstacle(content: Document, path: Path): readonly Row[] {
  if (get(content, [...path, "min"]) !== undefined) {
    return [...corners(content, path), ...others(content, path, new Set(["name", "min", "max"]))];
  }
  const rows: Row[] = [];
  for (const key of ["vertices", "line"]) {
    const list = get(content, [...path, key]);
    if (!isList(list)) continue;
    list.forEach((_, i) => rows.push(...coordinates(content, [...path, key, i], `Corner ${i + 1}`)));
  }
  return [...rows, ...others(content, path, new Set(["name", "vertices", "line"]))];
}

function corners(content: Document, path: Path): readonly Row[] {
  return [...coordinates(content, [...path, "min"], "Lower corner"), ...coordinates(content, [...path, "max"], "Upper corner")];
}

function coordinates(content: Document, path: Path, label: string): readonly Row[] {
  const list = get(content, path);
  if (!isList(list)) return [];
  const cells = list.map((_, i) => cell([...path, i], AXES[i] ?? String(i)));
  return [{ label, unit: "m", path, cells, otherwise: undefined, isOptional: false }];
}

/** Whatever else the document says of the thing, as it stands there. */
function others(content: Document, path: Path, shown: ReadonlySet<string>): readonly Row[] {
  const own = path.length === 0 ? content : get(content, path);
  if (!isMapping(own)) return [];
  return Object.keys(own)
    .filter((key) => !shown.has(key) && !key.startsWith("x-"))
    .map((key) => row([...path, key], labelOf(key), "", "json", undefined));
}

/** Keys that say too little without their surroundings. */
const WORDS: Readonly<Record<string, string>> = { for: "Only for", except: "Not for", keep: "Ranges to keep" };

/** A key in words. */
function labelOf(key: string): string {
  const words = key.replaceAll("_", " ");
  return WORDS[key] ?? `${words.charAt(0).toUpperCase()}${words.slice(1)}`;
}

function value(content: Document, path: Path, label: string, unit: string, otherwise: Json | undefined): Row {
  const now = get(content, path) ?? otherwise;
  const isNumber = now === undefined || typeof now === "number";
  return row(path, label, unit, isNumber ? "number" : "json", otherwise);
}

function name(path: Path): Row {
  return { ...row([...path, "name"], "Name", "", "text", undefined), isOptional: false };
}

function number(path: Path, label: string, unit: string): Row {
  return { ...row(path, label, unit, "number", undefined), isOptional: false };
}

function row(
  path: Path, label: string, unit: string, kind: Cell["kind"], otherwise: Json | undefined, choices?: readonly string[],
): Row {
  const only = { path, kind, label: "", ...(choices === undefined ? {} : { choices }) };
  return { label, unit, path, cells: [only], otherwise, isOptional: true };
}

function cell(path: Path, label: string): Cell {
  return { path, kind: "number", label };
}
