/** What stands or moves in the scene: workspace, obstacles, starts, goals. */

import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
} from "three";

import type { Box, ObstacleView } from "../protocol";
import type { Colors } from "../scene/colors";
import { sigmasOf } from "../scene/words";
import { displacement, point, type SpaceFrame } from "./types";
import { Uncertain } from "./uncertain";

const SHARPEST = 12; // angle between faces from which on their edge is drawn [°]

/** The edges of a box; of one without height those of its sides. */
export function boxEdges(box: Box, color: string, opacity = 1): LineSegments {
  const [low, high] = [point(box.min), point(box.max)];
  const size = [0, 1, 2].map((axis) => Math.max((high[axis] ?? 0) - (low[axis] ?? 0), 0));
  const edges = new EdgesGeometry(new BoxGeometry(size[0], size[1], size[2]));
  const lines = new LineSegments(
    edges,
    new LineBasicMaterial({ color, transparent: opacity < 1, opacity }),
  );
  lines.position.set((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2);
  return lines;
}

/** An obstacle as a translucent solid with its edges, which follows its motion. */
class Solid {
  readonly group = new Group();
  readonly mesh: Mesh;
  readonly #geometry = new BufferGeometry();
  readonly #rest: Float32Array;
  readonly #edges: LineSegments<EdgesGeometry>;

  constructor(
    readonly obstacle: ObstacleView,
    colors: Colors,
    isMarked: boolean,
  ) {
    this.#rest = new Float32Array(obstacle.corners.flatMap((corner) => point(corner)));
    this.#geometry.setAttribute("position", new BufferAttribute(this.#rest.slice(), 3));
    this.#geometry.setIndex(obstacle.triangles.flat());
    this.#geometry.computeVertexNormals();
    const material = new MeshLambertMaterial({
      color: colors.obstacle,
      transparent: true,
      opacity: 0.45,
      depthWrite: false,
      side: DoubleSide,
      flatShading: true,
    });
    this.#edges = new LineSegments(
      new EdgesGeometry(this.#geometry, SHARPEST),
      new LineBasicMaterial({ color: isMarked ? colors.accent : colors.obstacleEdge }),
    );
    this.mesh = new Mesh(this.#geometry, material);
    this.group.add(this.mesh, this.#edges);
  }

  moveTo(time: number): void {
    if (this.obstacle.moving === null) return;
    const places = this.#rest.slice();
    for (let corner = 0; corner < this.obstacle.corners.length; corner += 1) {
      displacement(this.obstacle, corner, time).forEach((by, axis) => {
        places[3 * corner + axis] = (places[3 * corner + axis] ?? 0) + by;
      });
    }
    this.#geometry.setAttribute("position", new BufferAttribute(places, 3));
    this.#geometry.computeBoundingSphere();
    this.#edges.geometry.dispose();
    this.#edges.geometry = new EdgesGeometry(this.#geometry, SHARPEST);
  }
}

/** All that is there before a plan. */
export class Solids {
  readonly group = new Group();
  /** What of obstacles is drawn, with the number of each. */
  readonly numbers: ReadonlyMap<Mesh, number>;
  readonly #solids: readonly Solid[];
  readonly #uncertain: readonly Uncertain[];

  constructor({ scenario: view, plan, colors, vehicleColors, highlight }: SpaceFrame) {
    const marked = highlight?.obstacles ?? [];
    if (view.workspace) this.group.add(boxEdges(view.workspace, colors.muted));
    this.#solids = view.obstacles
      .filter((obstacle) => obstacle.triangles.length > 0)
      .map((obstacle) => new Solid(obstacle, colors, marked.includes(obstacle.name)));
    this.numbers = new Map(this.#solids.map((solid) => [solid.mesh, view.obstacles.indexOf(solid.obstacle)]));
    this.#uncertain = this.#solids
      .filter(({ obstacle }) => obstacle.uncertain !== null)
      .map(({ obstacle }) => new Uncertain(obstacle, sigmasOf(plan), colors));
    for (const { group } of [...this.#solids, ...this.#uncertain]) this.group.add(group);
    view.vehicles.forEach((vehicle, index) => {
      const color = vehicleColors[index] ?? colors.text;
      this.group.add(boxEdges(vehicle.goal.box, color, 0.8));
      for (const via of vehicle.via) this.group.add(boxEdges(via.box, color, 0.5));
    });
  }

  moveTo(time: number): void {
    for (const solid of [...this.#solids, ...this.#uncertain]) solid.moveTo(time);
  }

  /** Gives back what is not in the scene now. */
  dispose(): void {
    for (const one of this.#uncertain) one.dispose();
  }
}
