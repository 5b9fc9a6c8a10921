/** What is under the pointer in space, in few words: a risk, a vehicle, an obstacle. */

import { type Object3D, type PerspectiveCamera, Raycaster, Vector2, Vector3 } from "three";

import { markText } from "../scene/layers/risk";
import { obstacleWords, vehicleWords } from "../scene/words";
import { riskPlaces } from "./tracks";
import type { SpaceFrame } from "./types";

const REACH = 10; // around a place [px]
const AWAY = 14; // of the text from the pointer [px]

/** What may be pointed at. */
export interface Pointed {
  readonly frame: SpaceFrame;
  readonly camera: PerspectiveCamera;
  readonly width: number;
  readonly height: number;
  readonly placeOf: (vehicle: number) => Vector3;
  /** Meshes by the number of their obstacle. */
  readonly solids: ReadonlyMap<Object3D, number>;
}

export class Tip {
  readonly #element = document.createElement("p");
  #at: readonly [number, number] | null = null;

  constructor(
    host: HTMLElement,
    readonly moved: () => void,
  ) {
    this.#element.className = "space-tip";
    this.#element.ariaHidden = "true"; // panels say the same
    this.#element.hidden = true;
    host.append(this.#element);
    host.addEventListener("pointermove", (event) => {
      const { left, top } = host.getBoundingClientRect();
      this.#point(event.buttons === 0 ? [event.clientX - left, event.clientY - top] : null);
    });
    host.addEventListener("pointerleave", () => this.#point(null));
    host.addEventListener("pointerdown", () => this.#point(null));
  }

  #point(at: readonly [number, number] | null): void {
    if (at === null && this.#at === null) return;
    this.#at = at;
    this.moved();
  }

  /** Says what is at the pointer now. */
  show(pointed: Pointed): void {
    const text = this.#at === null ? null : wordsAt(this.#at, pointed);
    this.#element.hidden = text === null;
    if (text === null || this.#at === null) return;
    if (this.#element.textContent !== text) this.#element.textContent = text;
    const [x, y] = this.#at;
    const { offsetWidth: wide, offsetHeight: high } = this.#element;
    const left = x + AWAY + wide <= pointed.width ? x + AWAY : Math.max(x - AWAY - wide, 0);
    const top = y + AWAY + high <= pointed.height ? y + AWAY : Math.max(y - AWAY - high, 0);
    this.#element.style.transform = `translate(${left.toFixed(0)}px, ${top.toFixed(0)}px)`;
  }
}

function wordsAt(at: readonly [number, number], pointed: Pointed): string | null {
  const { frame } = pointed;
  const { plan, scenario, switches } = frame;
  const marks = plan !== null && switches.risk ? riskPlaces(plan) : [];
  const mark = nearest(at, marks.map((one) => [one.at, one.radius] as const), pointed);
  if (mark !== null && plan !== null && marks[mark] !== undefined) {
    const { line } = marks[mark];
    return markText({ line, x: 0, y: 0, share: line.risk / plan.summary.riskBound });
  }
  const places = scenario.vehicles.map(({ radius }, i) => [pointed.placeOf(i), radius] as const);
  const vehicle = scenario.vehicles[nearest(at, places, pointed) ?? -1];
  if (vehicle !== undefined) return vehicleWords(vehicle);
  const obstacle = scenario.obstacles[solidAt(at, pointed) ?? -1];
  return obstacle === undefined ? null : obstacleWords(obstacle, plan);
}

/** Which of some balls is at a point of the screen, the one nearest to it; null is none. */
function nearest(
  [x, y]: readonly [number, number],
  balls: readonly (readonly [Vector3, number])[],
  { camera, width, height }: Pointed,
): number | null {
  const perMeter = height / (2 * Math.tan((camera.fov * Math.PI) / 360)); // at a distance of 1 m
  let best: number | null = null;
  let least = Infinity;
  balls.forEach(([place, radius], index) => {
    const seen = place.clone().project(camera);
    if (Math.abs(seen.z) > 1) return;
    const far = Math.hypot(((1 + seen.x) * width) / 2 - x, ((1 - seen.y) * height) / 2 - y);
    const reach = Math.max((radius * perMeter) / place.distanceTo(camera.position), REACH);
    if (far > reach || far >= least) return;
    [best, least] = [index, far];
  });
  return best;
}

function solidAt([x, y]: readonly [number, number], { camera, width, height, solids }: Pointed): number | null {
  const ray = new Raycaster();
  ray.setFromCamera(new Vector2((2 * x) / width - 1, 1 - (2 * y) / height), camera);
  const [first] = ray.intersectObjects([...solids.keys()], false);
  return first === undefined ? null : (solids.get(first.object) ?? null);
}
