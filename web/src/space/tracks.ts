/** Plans: tracks, hulls and ellipsoids at a time, where the risk is, trails. */

import {
  Color,
  DynamicDrawUsage,
  Group,
  InstancedMesh,
  Matrix4,
  MeshBasicMaterial,
  MeshLambertMaterial,
  SphereGeometry,
  Vector3,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

import type { Ellipse, PlanView, ScenarioView, TrailsView } from "../protocol.js";
import { colorOf, placeAt, point, type SpaceLook, type SpaceTheme } from "./types.js";

/** Many lines in their colors, some pixels wide, as one thing to draw. */
function lines(
  paths: readonly { readonly path: readonly (readonly number[])[]; readonly color: string }[],
  width: number,
  opacity: number,
): LineSegments2 {
  const [places, colors]: [number[], number[]] = [[], []];
  for (const { path, color } of paths) {
    const { r, g, b } = new Color(color);
    for (let index = 1; index < path.length; index += 1) {
      places.push(...point(path[index - 1] ?? []), ...point(path[index] ?? []));
      colors.push(r, g, b, r, g, b);
    }
  }
  const geometry = new LineSegmentsGeometry();
  if (places.length > 0) geometry.setPositions(places).setColors(colors);
  return new LineSegments2(
    geometry,
    new LineMaterial({ linewidth: width, vertexColors: true, transparent: opacity < 1, opacity }),
  );
}

/** Balls and ellipsoids, all of a kind as one thing to draw. */
function balls(colors: readonly string[], opacity: number): InstancedMesh {
  const material = new MeshLambertMaterial({
    transparent: opacity < 1,
    opacity,
    depthWrite: opacity === 1,
  });
  const mesh = new InstancedMesh(new SphereGeometry(1, 24, 16), material, colors.length);
  mesh.instanceMatrix.setUsage(DynamicDrawUsage);
  mesh.frustumCulled = false;
  colors.forEach((color, index) => mesh.setColorAt(index, new Color(color)));
  return mesh;
}

/** A unit ball turned and stretched into an ellipsoid of a covariance about a place. */
function ellipsoid(at: Vector3, ellipse: Ellipse | undefined, sigmas: number, grown: number): Matrix4 {
  const axes = [0, 1, 2].map((axis) => sigmas * (ellipse?.axes[axis] ?? 0) + grown);
  const turned = new Matrix4();
  const r = ellipse?.rotation;
  if (r?.length === 9) {
    const [a = 1, b = 0, c = 0, d = 0, e = 1, f = 0, g = 0, h = 0, i = 1] = r;
    turned.set(a, b, c, 0, d, e, f, 0, g, h, i, 0, 0, 0, 0, 1);
  } else {
    turned.makeRotationZ(ellipse?.angle ?? 0);
  }
  return turned.scale(new Vector3(axes[0], axes[1], axes[2])).setPosition(at);
}

/** The vehicles of a scenario, on their tracks where there is a plan. */
export class Fleet {
  readonly group = new Group();
  readonly #hulls: InstancedMesh;
  readonly #ellipsoids: InstancedMesh;

  constructor(
    readonly view: ScenarioView,
    readonly plan: PlanView | null,
    other: PlanView | null,
    theme: SpaceTheme,
  ) {
    const colors = view.vehicles.map((_, index) => colorOf(theme, index));
    this.#hulls = balls(colors, 1);
    this.#ellipsoids = balls(colors, 0.28);
    const tracks = (of: PlanView) =>
      of.tracks.map(({ path }, index) => ({ path, color: colors[index] ?? theme.ink }));
    if (plan) this.group.add(lines(tracks(plan), 2, 1));
    if (other) this.group.add(lines(tracks(other), 1.5, 0.45));
    this.group.add(this.#hulls, this.#ellipsoids);
  }

  /** Where a vehicle's center is. */
  placeOf(index: number, time: number): Vector3 {
    const track = this.plan?.tracks[index];
    const place = track
      ? placeAt(track.path, this.plan?.perStep ?? 1, time)
      : point(this.view.vehicles[index]?.start ?? []);
    return new Vector3(...place);
  }

  moveTo(look: SpaceLook): void {
    const sigmas = this.plan?.sigmas ?? 0;
    this.#hulls.visible = look.hulls || !this.plan;
    this.#ellipsoids.visible = look.discs && this.plan !== null;
    this.view.vehicles.forEach(({ radius, name }, index) => {
      const at = this.placeOf(index, look.time);
      const grown = radius * (look.marked.includes(name) ? 1.25 : 1);
      const round = new Matrix4().makeScale(grown, grown, grown).setPosition(at);
      const ellipses = this.plan?.tracks[index]?.ellipses;
      const step = Math.min(Math.round(look.time), Math.max((ellipses?.length ?? 1) - 1, 0));
      this.#hulls.setMatrixAt(index, round);
      this.#ellipsoids.setMatrixAt(index, ellipsoid(at, ellipses?.[step], sigmas, radius));
    });
    this.#hulls.instanceMatrix.needsUpdate = true;
    this.#ellipsoids.instanceMatrix.needsUpdate = true;
  }
}

/** Where a plan's risk is: a ball at each place, its volume the share of what is allowed. */
export function riskMarks(plan: PlanView, theme: SpaceTheme, look: SpaceLook): InstancedMesh {
  const size = plan.scenario.extent;
  const [low, high] = [point(size.min), point(size.max)];
  const largest = 0.04 * Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  const bound = plan.summary.riskBound;
  const lit = plan.ledger.filter(({ risk }) => risk > 1e-4 * bound);
  const material = new MeshBasicMaterial({ transparent: true, opacity: 0.7, depthTest: false });
  const mesh = new InstancedMesh(new SphereGeometry(1, 12, 8), material, lit.length);
  mesh.frustumCulled = false;
  lit.forEach((line, index) => {
    const share = Math.cbrt(Math.min(line.risk / bound, 1));
    const radius = Math.max(largest * share, 0.1 * largest);
    mesh.setMatrixAt(
      index,
      new Matrix4().makeScale(radius, radius, radius).setPosition(new Vector3(...point(line.at))),
    );
    mesh.setColorAt(index, new Color(line === look.line ? theme.accent : theme.alert));
  });
  return mesh;
}

/** Simulated missions as thin lines, those that collide in the color of alarm. */
export function trailLines(trails: TrailsView, theme: SpaceTheme): LineSegments2 {
  const paths = trails.trails.flatMap(({ paths: ways, collision }) =>
    ways.map((path) => ({ path, color: collision ? theme.alert : theme.muted })),
  );
  return lines(paths, 1, 0.35);
}
