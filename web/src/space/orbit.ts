/** A camera that turns about a place, by pointer, wheel and keys; z is up. */

import { PerspectiveCamera, Vector3 } from "three";

import type { Box } from "../protocol";
import { point } from "./types";

const TURN = Math.PI / 36; // of a key, 5°
const PER_PIXEL = 0.006; // of a drag [rad]
const ZOOM = 1.15; // of a key
const STEEPEST = Math.PI / 2 - 0.02;
const FIELD = 35; // of view, upright [°]

const FILLED = 0.84; // of the picture, by what is fitted: numbers stand beside it

/** The eight corners of a box. */
function cornersOf(low: Vector3, high: Vector3): Vector3[] {
  const [xs, ys, zs] = [[low.x, high.x], [low.y, high.y], [low.z, high.z]] as const;
  return xs.flatMap((x) => ys.flatMap((y) => zs.map((z) => new Vector3(x, y, z))));
}

export class Orbit {
  readonly camera = new PerspectiveCamera(FIELD, 1, 0.1, 1000);
  readonly #target = new Vector3();
  #size = 1;
  #distance = 1;
  #azimuth = -1.05;
  #elevation = 0.5;
  readonly #pointers = new Map<number, { x: number; y: number }>();
  readonly #stop = new AbortController();

  constructor(
    readonly host: HTMLElement,
    readonly moved: () => void,
  ) {
    this.camera.up.set(0, 0, 1);
    const options = { signal: this.#stop.signal };
    host.addEventListener("pointerdown", (event) => this.#down(event), options);
    host.addEventListener("pointermove", (event) => this.#drag(event), options);
    for (const kind of ["pointerup", "pointercancel"] as const) {
      host.addEventListener(kind, (event) => this.#pointers.delete(event.pointerId), options);
    }
    host.addEventListener("wheel", (event) => this.#wheel(event), { ...options, passive: false });
    host.addEventListener("keydown", (event) => this.#key(event), options);
    host.addEventListener("contextmenu", (event) => event.preventDefault(), options);
  }

  /** The direction that is looked from, for tests and for who draws axes [rad]. */
  get direction(): { readonly azimuth: number; readonly elevation: number } {
    return { azimuth: this.#azimuth, elevation: this.#elevation };
  }

  /** Shows all of a box, from where it was looked at. */
  fit(box: Box): void {
    const low = new Vector3(...point(box.min));
    const high = new Vector3(...point(box.max));
    this.#target.addVectors(low, high).multiplyScalar(0.5);
    this.#size = Math.max(low.distanceTo(high), 1e-3);
    this.#distance = this.#size;
    this.#place();
    // From here on the camera only draws back, so that corners stay where they are beside it.
    const up = FILLED * Math.tan((FIELD * Math.PI) / 360);
    const across = up * this.camera.aspect;
    const farthest = cornersOf(low, high).map((corner) => {
      const { x, y, z } = corner.applyMatrix4(this.camera.matrixWorldInverse);
      return this.#size + z + Math.max(Math.abs(x) / across, Math.abs(y) / up);
    });
    this.#distance = Math.max(...farthest);
    this.#place();
  }

  /** Takes the shape of what it is drawn on. */
  resize(width: number, height: number): void {
    this.camera.aspect = width / Math.max(height, 1);
    this.#place();
  }

  /** Comes nearer by a factor. */
  zoom(factor: number): void {
    const nearest = this.#size / 500;
    this.#distance = Math.min(Math.max(this.#distance / factor, nearest), 20 * this.#size);
    this.#place();
  }

  dispose(): void {
    this.#stop.abort();
  }

  #place(): void {
    const flat = this.#distance * Math.cos(this.#elevation);
    this.camera.position.set(
      this.#target.x + flat * Math.cos(this.#azimuth),
      this.#target.y + flat * Math.sin(this.#azimuth),
      this.#target.z + this.#distance * Math.sin(this.#elevation),
    );
    this.camera.near = this.#distance / 200;
    this.camera.far = this.#distance + 4 * this.#size;
    this.camera.lookAt(this.#target);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.moved();
  }

  #turn(about: number, up: number): void {
    this.#azimuth += about;
    this.#elevation = Math.min(Math.max(this.#elevation + up, -STEEPEST), STEEPEST);
    this.#place();
  }

  /** Moves what is looked at, by pixels of the screen. */
  #pan(dx: number, dy: number): void {
    const perPixel =
      (2 * this.#distance * Math.tan((FIELD * Math.PI) / 360)) / Math.max(this.host.clientHeight, 1);
    const right = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const up = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    this.#target.addScaledVector(right, -dx * perPixel).addScaledVector(up, dy * perPixel);
    this.#place();
  }

  #down(event: PointerEvent): void {
    this.host.focus({ preventScroll: true });
    this.host.setPointerCapture(event.pointerId);
    this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }

  #drag(event: PointerEvent): void {
    const last = this.#pointers.get(event.pointerId);
    if (last === undefined) return;
    const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
    const others = [...this.#pointers].filter(([id]) => id !== event.pointerId);
    const other = others[0]?.[1];
    if (other !== undefined) {
      // Two fingers: their distance zooms, their way moves.
      const before = Math.hypot(last.x - other.x, last.y - other.y);
      const after = Math.hypot(event.clientX - other.x, event.clientY - other.y);
      this.#pan(dx / 2, dy / 2);
      if (before > 0 && after > 0) this.zoom(after / before);
    } else if (event.shiftKey || event.buttons === 2 || event.buttons === 4) {
      this.#pan(dx, dy);
    } else {
      this.#turn(-dx * PER_PIXEL, dy * PER_PIXEL);
    }
    this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }

  #wheel(event: WheelEvent): void {
    event.preventDefault();
    this.zoom(Math.exp(-Math.min(Math.max(event.deltaY, -200), 200) / 400));
  }

  #key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = 24; // of a key that moves [px]
    const moves: Record<string, () => void> = event.shiftKey
      ? {
          ArrowLeft: () => this.#pan(step, 0),
          ArrowRight: () => this.#pan(-step, 0),
          ArrowUp: () => this.#pan(0, step),
          ArrowDown: () => this.#pan(0, -step),
        }
      : {
          ArrowLeft: () => this.#turn(-TURN, 0),
          ArrowRight: () => this.#turn(TURN, 0),
          ArrowUp: () => this.#turn(0, TURN),
          ArrowDown: () => this.#turn(0, -TURN),
        };
    moves["+"] = moves["="] = () => this.zoom(ZOOM);
    moves["-"] = () => this.zoom(1 / ZOOM);
    const move = moves[event.key];
    if (move === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    move();
  }
}
