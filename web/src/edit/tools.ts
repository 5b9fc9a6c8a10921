/** Tools of the map: what a click means, and what has been drawn so far. */

import { signal } from "@preact/signals";
import { selected } from "../state/selection";
import { isFromAbove, tell } from "../state/session";
import { addObstacle, addVehicle, addWaypoint } from "./create";

export type Tool = "select" | "vehicle" | "waypoint" | "polygon" | "box" | "line";

type Point = readonly [number, number];

/** Points set so far, and the one under the pointer [m]. */
export interface Draft {
  readonly tool: Tool;
  readonly points: readonly Point[];
  readonly cursor: Point | null;
}

export const tool = signal<Tool>("select");

export const draft = signal<Draft | null>(null);

const NO_VEHICLE = "Select the vehicle first that is to visit a place";

/** What to do next with a tool, in words. */
export function hintOf(name: Tool, count: number): string {
  switch (name) {
    case "select":
      return "";
    case "vehicle":
      return count === 0 ? "Click where the vehicle starts" : "Click its goal";
    case "waypoint":
      return "Click a place that the selected vehicle is to visit";
    case "box":
      return count === 0 ? "Click a corner" : "Click the opposite corner";
    case "polygon":
      return count < 3 ? "Click corners, three at least" : "Click corners; Enter or double click ends";
    case "line":
      return count < 2 ? "Click points, two at least" : "Click points; Enter or double click ends";
  }
}

export function choose(name: Tool): void {
  if (name === "waypoint" && selected.peek()?.path[0] !== "vehicles") {
    tell(NO_VEHICLE);
    return;
  }
  tool.value = name;
  if (name !== "select") isFromAbove.value = true;
  draft.value = name === "select" ? null : { tool: name, points: [], cursor: null };
}

/** Drop what was drawn; with nothing drawn, put the tool away. */
export function cancel(): void {
  const now = draft.peek();
  if (now !== null && now.points.length > 0) draft.value = { ...now, points: [] };
  else choose("select");
}

/** Move the point under the pointer. */
export function hover(point: Point | null): void {
  const now = draft.peek();
  if (now !== null) draft.value = { ...now, cursor: point };
}

/** Set a point. */
export function place(point: Point): void {
  const now = draft.peek();
  if (now === null) return;
  const last = now.points.at(-1);
  // A double click sets its point once.
  if (last !== undefined && last[0] === point[0] && last[1] === point[1]) return;
  const points = [...now.points, point];
  const isWhole = { select: 0, vehicle: 2, waypoint: 1, box: 2, polygon: Infinity, line: Infinity }[now.tool];
  draft.value = { ...now, points, cursor: point };
  if (points.length >= isWhole) end();
}

/** Take back the last point. */
export function takeBack(): void {
  const now = draft.peek();
  if (now !== null) draft.value = { ...now, points: now.points.slice(0, -1) };
}

/** Make the thing that was drawn, if it is enough for one. */
export function end(): void {
  const now = draft.peek();
  if (now === null) return;
  const [first, second] = now.points;
  const thing = selected.peek();
  switch (now.tool) {
    case "vehicle":
      if (first === undefined || second === undefined) return;
      void addVehicle(first, second);
      break;
    case "waypoint":
      if (first === undefined) return;
      // Another thing may have been selected, or this one removed, since the tool was taken up.
      if (thing?.path[0] === "vehicles") void addWaypoint(thing, first);
      else tell(NO_VEHICLE);
      break;
    case "box":
      if (now.points.length < 2) return;
      void addObstacle("box", now.points);
      break;
    case "polygon":
    case "line":
      if (now.points.length < (now.tool === "line" ? 2 : 3)) return;
      void addObstacle(now.tool, now.points);
      break;
    case "select":
      return;
  }
  // What was made is selected, ready to be moved.
  choose("select");
}

/** Words for who does not see the map. */
export const announcement = signal("");

export function announce(text: string): void {
  announcement.value = text;
}
