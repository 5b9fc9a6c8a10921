/** What the view in space is told, in protocol's values and plain colors. */

import type { LedgerLine, PlanView, ScenarioView, TrailsView } from "../protocol.js";

/** What there is to see. */
export interface SpaceScene {
  readonly view: ScenarioView;
  readonly plan: PlanView | null;
  /** A second plan, drawn faintly beside the first. */
  readonly other: PlanView | null;
  readonly trails: TrailsView | null;
}

/** When and how it is looked at. */
export interface SpaceLook {
  /** In steps; halves are between two. */
  readonly time: number;
  readonly discs: boolean;
  readonly hulls: boolean;
  readonly risk: boolean;
  readonly trails: boolean;
  /** Names of vehicles and obstacles to stand out. */
  readonly marked: readonly string[];
  /** A line of the ledger that is pointed at elsewhere. */
  readonly line: LedgerLine | null;
}

/** Colors, as CSS writes them. */
export interface SpaceTheme {
  readonly background: string;
  readonly ink: string;
  readonly muted: string;
  readonly grid: string;
  readonly obstacle: string;
  readonly obstacleEdge: string;
  readonly accent: string;
  readonly alert: string;
  /** Of vehicles, in turn. */
  readonly vehicles: readonly string[];
}

/** Three coordinates [m]. */
export type Point = readonly [number, number, number];

/** A place as three coordinates, whatever the list has. */
export function point(at: readonly number[]): Point {
  return [at[0] ?? 0, at[1] ?? 0, at[2] ?? 0];
}

/** The color of a vehicle by its place in the scenario. */
export function colorOf(theme: SpaceTheme, index: number): string {
  return theme.vehicles[index % theme.vehicles.length] ?? theme.ink;
}

/** A place on a list of places of which there are `perStep` for each step. */
export function placeAt(path: readonly (readonly number[])[], perStep: number, time: number): Point {
  const at = Math.min(Math.max(time * perStep, 0), Math.max(path.length - 1, 0));
  const low = Math.floor(at);
  const before = point(path[low] ?? []);
  const after = point(path[low + 1] ?? path[low] ?? []);
  const part = at - low;
  return [
    before[0] + part * (after[0] - before[0]),
    before[1] + part * (after[1] - before[1]),
    before[2] + part * (after[2] - before[2]),
  ];
}
