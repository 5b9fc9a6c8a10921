/** Scenarios as the page draws and changes them: half of the protocol, as `src/radmpc/serving/scenes.py`. */

/** A place in a document: keys and indices from its root. */
export type Path = readonly (string | number)[];

/** Anything that JSON can say. */
export type Json = null | boolean | number | string | readonly Json[] | { readonly [key: string]: Json };

/** A scenario as its file has it (`radmpc/scenario/1`), as plain data. */
export type Document = { readonly [key: string]: Json };

/** Something wrong, or something worth knowing, in the words of `radmpc check`. */
export interface Remark {
  /** `error`: the scenario cannot be read; `fatal`: no plan can hold the bound; `warning`. */
  readonly severity: "error" | "fatal" | "warning";
  readonly text: string;
  /** Where in the document, as exactly as is known. */
  readonly path: Path;
  /** Names of the vehicles that it is about; empty is none in particular. */
  readonly vehicles: readonly string[];
  /** Where on the map [m], where there is a place. */
  readonly at: readonly number[] | null;
  /** Changes of the document that cure it. */
  readonly cures: readonly Cure[];
}

/** A change that removes a cause, as a button. */
export interface Cure {
  readonly label: string;
  readonly changes: readonly Change[];
}

/** One value of a document to be replaced, or taken away where `value` is undefined. */
export interface Change {
  readonly path: Path;
  readonly value?: Json;
}

/**
 * A point on the map that can be dragged. Moving it by (dx, dy) adds dx to the numbers at `x`, dy to
 * those at `y`; in space dz to those at `z`. Of an obstacle described by half-spaces these are the
 * numbers of the corners that take their place.
 */
export interface Handle {
  readonly at: readonly number[];
  readonly x: readonly Path[];
  readonly y: readonly Path[];
  readonly z: readonly Path[];
}

/** A polygon: outer outline first, then holes; corners [m]. */
export type Rings = readonly (readonly (readonly [number, number])[])[];

/** One obstacle, ready to be drawn. */
export interface ObstacleView {
  readonly name: string;
  readonly path: Path;
  /** `line` has no inside. */
  readonly kind: "polygon" | "line" | "solid";
  /** In the plane, at step 0. */
  readonly rings: Rings;
  /** In space: corners and triangles of indices into them, at step 0. */
  readonly corners: readonly (readonly number[])[];
  readonly triangles: readonly (readonly [number, number, number])[];
  /** Displacement of every corner at each step, where it moves: one list per step; else null.
   * Rings are displaced in their order, one outline after the other. */
  readonly moving: readonly (readonly (readonly number[])[])[] | null;
  /** Where its place is uncertain: half axes [m] and angle [rad] at each step, one deviation. */
  readonly uncertain: readonly Ellipse[] | null;
  /** Whom it stands in the way of where that is not everybody: `for tanker`. */
  readonly only: string | null;
  /** The whole of it, then its corners. */
  readonly handles: readonly Handle[];
}

/** A covariance of a place as drawn: half axes of one standard deviation [m], angle of the first
 * against x [rad]. In space there are three axes and a rotation, row by row. */
export interface Ellipse {
  readonly axes: readonly number[];
  readonly angle: number;
  readonly rotation: readonly number[] | null;
}

/** A box of the map [m]. */
export interface Box {
  readonly min: readonly number[];
  readonly max: readonly number[];
}

/** Something a vehicle is to visit, or to come to. */
export interface GoalView {
  readonly box: Box;
  readonly path: Path;
  readonly label: string;
  readonly handles: readonly Handle[];
}

/** One vehicle of a scenario, ready to be drawn. */
export interface VehicleView {
  readonly name: string;
  readonly path: Path;
  readonly radius: number;
  readonly start: readonly number[];
  readonly startHandle: Handle | null;
  readonly goal: GoalView;
  readonly via: readonly GoalView[];
}

/** Two vehicles that are to stay within a distance [m] of each other. */
export interface RangeView {
  readonly vehicles: readonly string[];
  readonly within: number;
}

/** A scenario, ready to be drawn. */
export interface ScenarioView {
  readonly name: string;
  readonly dimension: 2 | 3;
  readonly dt: number;
  readonly horizon: number;
  readonly riskBound: number;
  readonly avoidance: "intervals" | "steps";
  readonly workspace: Box | null;
  readonly workspaceHandles: readonly Handle[];
  readonly vehicles: readonly VehicleView[];
  readonly obstacles: readonly ObstacleView[];
  readonly ranges: readonly RangeView[];
  /** What all of it takes up [m]. */
  readonly extent: Box;
}
