/** Axes with their units, a grid on the ground, names beside vehicles: texts are HTML over the picture. */

import {
  BufferGeometry,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineSegments,
  type PerspectiveCamera,
  Vector3,
} from "three";

import type { Box } from "../protocol";
import type { Colors } from "../scene/colors";
import { shortened, type Spot, Taken } from "../scene/placing";
import { HIGH, type Mark, namePlaces } from "./naming";
import { point, type Point } from "./types";

const LONGEST = 32; // letters of a name; of more some are left out in its middle
const MOST_NAMES = 200; // more would hide what they name, however near one comes

/** Round numbers of a range, about `count` of them. */
export function ticks(low: number, high: number, count = 5): readonly number[] {
  const raw = Math.max(high - low, 1e-9) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= raw) ?? 10);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, index) => (first + index) * step);
}

/** A number as short as its step allows. */
function told(value: number): string {
  return String(Number(value.toPrecision(6))).replace("-", "−");
}

interface Label {
  readonly element: HTMLElement;
  at: Vector3;
  /** On the screen [px]; 0 until it was seen. */
  width: number;
}

const SMALLEST = 4; // that a vehicle counts as, on the screen [px]

/** A vehicle whose name is written: where it is, and its radius [m]. */
export interface Named {
  readonly at: Vector3;
  readonly radius: number;
}

/** Where a label's place is on the screen [px]; null where it is not seen. */
function seenAt({ at }: Label, camera: PerspectiveCamera, width: number, height: number): readonly [number, number] | null {
  const { x, y, z } = at.clone().project(camera);
  const isSeen = z > -1 && z < 1 && Math.abs(x) < 1.02 && Math.abs(y) < 1.02;
  return isSeen ? [((1 + x) * width) / 2, ((1 - y) * height) / 2] : null;
}

/** The width of a text that stays the same: measured once, when it can be. */
function widthOf(label: Label): number {
  if (label.width > 0) return label.width;
  label.element.hidden = false;
  label.width = label.element.offsetWidth;
  return label.width;
}

function put({ element }: Label, spot: Spot | null): void {
  element.hidden = spot === null;
  if (spot !== null) element.style.transform = `translate(${spot.left.toFixed(1)}px, ${spot.top.toFixed(1)}px)`;
}

export class Axes {
  readonly group = new Group();
  readonly #low: Point;
  readonly #high: Point;
  readonly #layer = document.createElement("div");
  readonly #marks: { axis: number; value: number | null; label: Label }[] = [];
  readonly #names: readonly Label[];

  constructor(host: HTMLElement, box: Box, names: readonly string[], colors: Colors) {
    [this.#low, this.#high] = [point(box.min), point(box.max)];
    this.#layer.className = "space-labels";
    // What they say is told to who cannot see them by the list of things and the properties.
    this.#layer.ariaHidden = "true";
    host.append(this.#layer);
    for (let axis = 0; axis < 3; axis += 1) {
      const [low, high] = [this.#low[axis] ?? 0, this.#high[axis] ?? 0];
      for (const value of ticks(low, high)) {
        this.#marks.push({ axis, value, label: this.#label(told(value), "space-tick") });
      }
      const name = `${"xyz".charAt(axis)} [m]`;
      this.#marks.push({ axis, value: null, label: this.#label(name, "space-axis") });
    }
    const shown = names.length <= MOST_NAMES ? names : [];
    this.#names = shown.map((name) => this.#label(shortened(name, ({ length }) => length <= LONGEST), "space-name"));
    this.group.add(this.#ground(colors));
  }

  dispose(): void {
    this.#layer.remove();
  }

  /** Puts texts where their places are now. */
  place(camera: PerspectiveCamera, width: number, height: number, vehicles: readonly Named[]): void {
    const center = this.#at(0.5, 0.5, 0.5);
    const nearX = camera.position.x < center.x ? 0 : 1;
    const nearY = camera.position.y < center.y ? 0 : 1;
    const corners = [this.#at(nearX, 1 - nearY, 0), this.#at(1 - nearX, nearY, 0)];
    const [one, two] = corners.map((corner) => corner.clone().project(camera).x);
    const left = (one ?? 0) < (two ?? 0) ? corners[0] : corners[1];
    for (const { axis, value, label } of this.#marks) {
      const span = (this.#high[axis] ?? 0) - (this.#low[axis] ?? 0);
      const part = value === null ? 0.5 : (value - (this.#low[axis] ?? 0)) / (span || 1);
      // Names of axes stand outside of their numbers.
      const out = value === null ? 0.13 : 0.04; // of the upright one, above them
      if (axis === 0) label.at = this.#at(part, nearY + (nearY ? out : -out), 0);
      else if (axis === 1) label.at = this.#at(nearX + (nearX ? out : -out), part, 0);
      else label.at = this.#beside(left ?? center, center, 0.04, value === null ? 1.08 : part);
    }
    // Names of axes first: where it is narrow, a number less is better than two over each other.
    const marks = [...this.#marks].sort((one, other) => Number(other.value === null) - Number(one.value === null));
    const taken = new Taken();
    const written: Spot[] = [];
    for (const { label } of marks) {
      const pixel = seenAt(label, camera, width, height);
      const spot = pixel && taken.claim([{ left: pixel[0] - HIGH / 2, top: pixel[1] - HIGH / 2, width: widthOf(label), height: HIGH }]);
      put(label, spot);
      if (spot) written.push(spot);
    }
    this.#placeNames(camera, width, height, vehicles, written);
  }

  /** Puts names beside those vehicles that are seen; they keep off the texts that are written already. */
  #placeNames(camera: PerspectiveCamera, width: number, height: number, vehicles: readonly Named[], texts: readonly Spot[]): void {
    const seen: Label[] = [];
    const marks: Mark[] = [];
    const perMeter = height / (2 * Math.tan((camera.fov * Math.PI) / 360)); // a meter away
    this.#names.forEach((label, index) => {
      const vehicle = vehicles[index];
      label.at = vehicle?.at ?? label.at;
      const pixel = vehicle ? seenAt(label, camera, width, height) : null;
      label.element.hidden = true;
      if (!vehicle || pixel === null) return;
      const away = camera.position.distanceTo(vehicle.at);
      const radius = Math.max((vehicle.radius * perMeter) / Math.max(away, 1e-9), SMALLEST);
      seen.push(label);
      marks.push({ px: pixel[0], py: pixel[1], radius, away, width: widthOf(label) });
    });
    const places = namePlaces(marks, texts, width * height);
    seen.forEach((label, index) => put(label, places[index] ?? null));
  }

  /** A place by its parts of the box along each axis. */
  #at(x: number, y: number, z: number): Vector3 {
    const [low, high] = [this.#low, this.#high];
    const between = (axis: 0 | 1 | 2, part: number) => low[axis] + part * (high[axis] - low[axis]);
    return new Vector3(between(0, x), between(1, y), between(2, z));
  }

  /** A place on the upright edge at a corner, moved away from the middle. */
  #beside(corner: Vector3, center: Vector3, out: number, part: number): Vector3 {
    const away = corner.clone().sub(center).setZ(0).multiplyScalar(out * 1.4);
    return corner.clone().add(away).setZ(this.#at(0, 0, part).z);
  }

  #label(text: string, kind: string): Label {
    const element = document.createElement("span");
    element.className = kind;
    element.textContent = text;
    this.#layer.append(element);
    return { element, at: new Vector3(), width: 0 };
  }

  #ground(colors: Colors): LineSegments {
    const [[x0, y0, z], [x1, y1]] = [this.#low, this.#high];
    const places: number[] = [];
    // Those of the edges are the workspace's already.
    const inside = (low: number, high: number) =>
      ticks(low, high).filter((value) => value > low && value < high);
    for (const x of inside(x0, x1)) places.push(x, y0, z, x, y1, z);
    for (const y of inside(y0, y1)) places.push(x0, y, z, x1, y, z);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(places, 3));
    return new LineSegments(geometry, new LineBasicMaterial({ color: colors.gridStrong }));
  }
}
