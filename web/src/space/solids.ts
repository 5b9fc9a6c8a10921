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
import { point, type SpaceFrame } from "./types";

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
    this.group.add(new Mesh(this.#geometry, material), this.#edges);
  }

  moveTo(time: number): void {
    const { moving } = this.obstacle;
    if (moving === null || moving.length === 0) return;
    const at = Math.min(Math.max(time, 0), moving.length - 1);
    const before = moving[Math.floor(at)] ?? [];
    const after = moving[Math.floor(at) + 1] ?? before;
    const part = at - Math.floor(at);
    const places = this.#rest.slice();
    for (let corner = 0; corner < this.obstacle.corners.length; corner += 1) {
      const [from, to] = [point(before[corner] ?? []), point(after[corner] ?? [])];
      for (let axis = 0; axis < 3; axis += 1) {
        const [low, high] = [from[axis] ?? 0, to[axis] ?? 0];
        places[3 * corner + axis] = (places[3 * corner + axis] ?? 0) + low + part * (high - low);
      }
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
  readonly #solids: readonly Solid[];

  constructor({ scenario: view, colors, vehicleColors, highlight }: SpaceFrame) {
    const marked = highlight?.obstacles ?? [];
    if (view.workspace) this.group.add(boxEdges(view.workspace, colors.muted));
    this.#solids = view.obstacles
      .filter((obstacle) => obstacle.triangles.length > 0)
      .map((obstacle) => new Solid(obstacle, colors, marked.includes(obstacle.name)));
    for (const solid of this.#solids) this.group.add(solid.group);
    view.vehicles.forEach((vehicle, index) => {
      const color = vehicleColors[index] ?? colors.text;
      this.group.add(boxEdges(vehicle.goal.box, color, 0.8));
      for (const via of vehicle.via) this.group.add(boxEdges(via.box, color, 0.5));
    });
  }

  moveTo(time: number): void {
    for (const solid of this.#solids) solid.moveTo(time);
  }
}
