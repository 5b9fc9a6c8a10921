/** Where an uncertain obstacle may be: its hull with so many standard deviations around it. */

import { type BufferGeometry, DoubleSide, Group, Mesh, MeshBasicMaterial, Vector3 } from "three";
import { ConvexGeometry } from "three/addons/geometries/ConvexGeometry.js";

import type { Ellipse, ObstacleView } from "../protocol";
import type { Colors } from "../scene/colors";
import { displacement, point } from "./types";

const DIRECTIONS = 60; // in which a ball's hull has corners
const GOLDEN = Math.PI * (3 - Math.sqrt(5)); // angle by which they go around [rad]

/** Directions that are evenly spread. */
const directions = Array.from({ length: DIRECTIONS }, (_, index) => {
  const z = 1 - (2 * index + 1) / DIRECTIONS;
  const radius = Math.sqrt(1 - z * z);
  return new Vector3(radius * Math.cos(GOLDEN * index), radius * Math.sin(GOLDEN * index), z);
});

/** Half axes of an ellipsoid, each as long as so many standard deviations. */
function halfAxes({ axes, rotation }: Ellipse, sigmas: number): readonly Vector3[] {
  return [0, 1, 2].map((axis) => {
    const along = rotation === null ? [0, 1, 2].map((row) => (row === axis ? 1 : 0)) : [0, 1, 2].map((row) => rotation[3 * row + axis] ?? 0);
    return new Vector3(...point(along)).multiplyScalar(sigmas * (axes[axis] ?? 0));
  });
}

export class Uncertain {
  readonly group = new Group();
  readonly #mesh: Mesh<BufferGeometry, MeshBasicMaterial>;
  readonly #known = new Map<number, BufferGeometry>();

  constructor(
    readonly obstacle: ObstacleView,
    readonly sigmas: number,
    colors: Colors,
  ) {
    const material = new MeshBasicMaterial({
      color: colors.muted,
      transparent: true,
      opacity: 0.16,
      depthWrite: false,
      side: DoubleSide,
    });
    this.#mesh = new Mesh(this.#hull(0), material);
    this.group.add(this.#mesh);
  }

  moveTo(time: number): void {
    this.#mesh.geometry = this.#hull(Math.round(time));
    this.#mesh.position.set(...displacement(this.obstacle, 0, time));
  }

  dispose(): void {
    for (const hull of this.#known.values()) hull.dispose();
  }

  /** The hull around the obstacle where it stands at first; made once for every step. */
  #hull(step: number): BufferGeometry {
    const ellipses = this.obstacle.uncertain ?? [];
    const at = Math.min(Math.max(step, 0), Math.max(ellipses.length - 1, 0));
    const known = this.#known.get(at);
    if (known !== undefined) return known;
    const [u, v, w] = halfAxes(ellipses[at] ?? { axes: [], angle: 0, rotation: null }, this.sigmas);
    const ball = directions.map(({ x, y, z }) =>
      new Vector3().addScaledVector(u ?? new Vector3(), x).addScaledVector(v ?? new Vector3(), y).addScaledVector(w ?? new Vector3(), z),
    );
    const places = this.obstacle.corners.flatMap((corner) => {
      const from = new Vector3(...point(corner));
      return ball.map((away) => from.clone().add(away));
    });
    const made = new ConvexGeometry(places);
    this.#known.set(at, made);
    return made;
  }
}
