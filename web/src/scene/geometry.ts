/**
 * Views as flat arrays, made once per view, so that a frame allocates nothing.
 *
 * Coordinates are interleaved: x₀, y₀, x₁, y₁, … [m].
 */

import type { Ellipse, ObstacleView, PlanView } from "../protocol";

/** Bounds [m]. */
export interface Bounds {
  minX: number;
  minY: number;
  maxX: number;
  maxY: number;
}

/** An obstacle at step 0: outer outlines counterclockwise, holes clockwise, whatever the file says. */
export interface Shape {
  readonly rings: readonly Float64Array[];
  readonly bounds: Bounds;
  readonly x: number;
  readonly y: number;
}

/** A plan's tracks. */
export interface Tracks {
  readonly paths: readonly Float64Array[];
  readonly bounds: readonly Bounds[];
  /** Covariance at each step: xx, xy, yy [m²]. */
  readonly covariances: readonly Float64Array[];
  readonly perStep: number;
}

const shapes = new WeakMap<ObstacleView, Shape>();
const tracks = new WeakMap<PlanView, Tracks>();

/** The obstacle's outlines; a solid's are its outline from above. */
export function shapeOf(obstacle: ObstacleView): Shape {
  const known = shapes.get(obstacle);
  if (known !== undefined) return known;
  const source = obstacle.kind === "solid" ? [hull(obstacle.corners)] : obstacle.rings;
  const rings = source.map((ring, i) => {
    const flat = flatten(ring);
    if (obstacle.kind !== "line" && area(flat) < 0 !== i > 0) reverse(flat);
    return flat;
  });
  const bounds = boundsOf(rings);
  const x = (bounds.minX + bounds.maxX) / 2;
  const y = (bounds.minY + bounds.maxY) / 2;
  const shape = { rings, bounds, x, y };
  shapes.set(obstacle, shape);
  return shape;
}

/** The plan's tracks. */
export function tracksOf(plan: PlanView): Tracks {
  const known = tracks.get(plan);
  if (known !== undefined) return known;
  const paths = plan.tracks.map((track) => flatten(track.path));
  const made = {
    paths,
    bounds: paths.map((path) => boundsOf([path])),
    covariances: plan.tracks.map((track) => covariances(track.ellipses)),
    perStep: plan.perStep,
  };
  tracks.set(plan, made);
  return made;
}

/** Coordinates of a path at a time [steps], written into `out` from `offset` on. */
export function placeAt(path: Float64Array, perStep: number, time: number, out: Float64Array, offset = 0): void {
  const last = path.length / 2 - 1;
  const at = Math.min(Math.max(time * perStep, 0), last);
  const i = Math.min(Math.floor(at), Math.max(last - 1, 0));
  const share = at - i;
  const j = Math.min(i + 1, last);
  out[offset] = num(path, 2 * i) * (1 - share) + num(path, 2 * j) * share;
  out[offset + 1] = num(path, 2 * i + 1) * (1 - share) + num(path, 2 * j + 1) * share;
}

/** Half axes [m] and angle [rad] of one deviation at a time [steps], written into `out`. */
export function ellipseAt(covariance: Float64Array, time: number, out: Float64Array): void {
  const last = covariance.length / 3 - 1;
  const at = Math.min(Math.max(time, 0), last);
  const i = Math.min(Math.floor(at), Math.max(last - 1, 0));
  const j = Math.min(i + 1, last);
  const share = at - i;
  const xx = num(covariance, 3 * i) * (1 - share) + num(covariance, 3 * j) * share;
  const xy = num(covariance, 3 * i + 1) * (1 - share) + num(covariance, 3 * j + 1) * share;
  const yy = num(covariance, 3 * i + 2) * (1 - share) + num(covariance, 3 * j + 2) * share;
  const half = (xx - yy) / 2;
  const root = Math.sqrt(half * half + xy * xy);
  out[0] = Math.sqrt(Math.max((xx + yy) / 2 + root, 0));
  out[1] = Math.sqrt(Math.max((xx + yy) / 2 - root, 0));
  out[2] = Math.atan2(xy, half) / 2;
}

/** A number of an array that is known to be there. */
export function num(values: ArrayLike<number>, i: number): number {
  return values[i] ?? 0;
}

/** Covariances of ellipses, step by step: xx, xy, yy [m²]. */
export function covariances(ellipses: readonly Ellipse[]): Float64Array {
  const out = new Float64Array(3 * ellipses.length);
  ellipses.forEach(({ axes, angle, rotation }, k) => {
    const c = Math.cos(angle);
    const s = Math.sin(angle);
    const matrix = rotation ?? [c, -s, s, c];
    const n = rotation === null ? 2 : 3;
    for (let a = 0; a < n; a += 1) {
      const variance = num(axes, a) ** 2;
      const ux = num(matrix, a);
      const uy = num(matrix, n + a);
      out[3 * k] = num(out, 3 * k) + variance * ux * ux;
      out[3 * k + 1] = num(out, 3 * k + 1) + variance * ux * uy;
      out[3 * k + 2] = num(out, 3 * k + 2) + variance * uy * uy;
    }
  });
  return out;
}

/** Whether a point is inside of a shape moved by (dx, dy), holes left out. */
export function isInside(shape: Shape, x: number, y: number): boolean {
  const { bounds } = shape;
  if (x < bounds.minX || x > bounds.maxX || y < bounds.minY || y > bounds.maxY) return false;
  let inside = false;
  for (const ring of shape.rings) {
    const count = ring.length / 2;
    for (let i = 0, j = count - 1; i < count; j = i, i += 1) {
      const yi = num(ring, 2 * i + 1);
      const yj = num(ring, 2 * j + 1);
      if (yi > y === yj > y) continue;
      const xi = num(ring, 2 * i);
      const xj = num(ring, 2 * j);
      if (x < xi + ((xj - xi) * (y - yi)) / (yj - yi)) inside = !inside;
    }
  }
  return inside;
}

/** Distance of a point from a chain of segments [m]. */
export function distanceTo(path: Float64Array, isClosed: boolean, x: number, y: number): number {
  const count = path.length / 2;
  if (count === 1) return Math.hypot(x - num(path, 0), y - num(path, 1));
  let least = Infinity;
  for (let i = isClosed ? 0 : 1; i < count; i += 1) {
    const j = i === 0 ? count - 1 : i - 1;
    const ax = num(path, 2 * j);
    const ay = num(path, 2 * j + 1);
    const dx = num(path, 2 * i) - ax;
    const dy = num(path, 2 * i + 1) - ay;
    const length = dx * dx + dy * dy;
    const share = length === 0 ? 0 : Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / length, 0), 1);
    const ex = x - ax - share * dx;
    const ey = y - ay - share * dy;
    least = Math.min(least, ex * ex + ey * ey);
  }
  return Math.sqrt(least);
}

function flatten(points: readonly (readonly number[])[]): Float64Array {
  const flat = new Float64Array(2 * points.length);
  points.forEach((point, i) => {
    flat[2 * i] = num(point, 0);
    flat[2 * i + 1] = num(point, 1);
  });
  return flat;
}

function boundsOf(paths: readonly Float64Array[]): Bounds {
  const bounds = { minX: Infinity, minY: Infinity, maxX: -Infinity, maxY: -Infinity };
  for (const path of paths) {
    for (let i = 0; i < path.length; i += 2) {
      bounds.minX = Math.min(bounds.minX, num(path, i));
      bounds.maxX = Math.max(bounds.maxX, num(path, i));
      bounds.minY = Math.min(bounds.minY, num(path, i + 1));
      bounds.maxY = Math.max(bounds.maxY, num(path, i + 1));
    }
  }
  return bounds;
}

function area(ring: Float64Array): number {
  let sum = 0;
  const count = ring.length / 2;
  for (let i = 0, j = count - 1; i < count; j = i, i += 1) {
    sum += num(ring, 2 * j) * num(ring, 2 * i + 1) - num(ring, 2 * i) * num(ring, 2 * j + 1);
  }
  return sum / 2;
}

function reverse(ring: Float64Array): void {
  const count = ring.length / 2;
  const copy = ring.slice();
  for (let i = 0; i < count; i += 1) {
    ring[2 * i] = num(copy, 2 * (count - 1 - i));
    ring[2 * i + 1] = num(copy, 2 * (count - 1 - i) + 1);
  }
}

/** Convex outline from above, counterclockwise. */
function hull(corners: readonly (readonly number[])[]): [number, number][] {
  const points = corners.map((c): [number, number] => [num(c, 0), num(c, 1)]);
  points.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (ordered: readonly [number, number][]) => {
    const chain: [number, number][] = [];
    for (const point of ordered) {
      while (chain.length > 1 && !turnsLeft(chain, point)) chain.pop();
      chain.push(point);
    }
    return chain.slice(0, -1);
  };
  return points.length < 3 ? points : [...half(points), ...half([...points].reverse())];
}

function turnsLeft(chain: readonly [number, number][], point: [number, number]): boolean {
  const [ax, ay] = chain[chain.length - 2] ?? point;
  const [bx, by] = chain[chain.length - 1] ?? point;
  return (bx - ax) * (point[1] - ay) - (by - ay) * (point[0] - ax) > 0;
}
