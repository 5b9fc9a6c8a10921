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

import type { Ellipse, FlightState, LedgerLine, PlanView, TrailsView } from "../protocol";
import type { Colors } from "../scene/colors";
import { causeColor } from "../scene/layers/causes";
import { marksOf } from "../scene/layers/risk";
import { placeAt, point, type SpaceFrame } from "./types";

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
  readonly #tracks: LineSegments2;

  constructor(readonly frame: SpaceFrame) {
    const { scenario, plan, compared, colors, vehicleColors } = frame;
    const own = scenario.vehicles.map((_, index) => vehicleColors[index] ?? colors.text);
    this.#hulls = balls(own, 1);
    this.#ellipsoids = balls(own, 0.28);
    const tracks = (of: PlanView | null) =>
      (of?.tracks ?? []).map(({ path }, index) => ({ path, color: own[index] ?? colors.text }));
    this.#tracks = lines(tracks(plan), 2, 1);
    this.group.add(this.#tracks, this.#hulls, this.#ellipsoids);
    if (compared) this.group.add(lines(tracks(compared), 1.5, 0.45));
  }

  /** Where a vehicle's center is. */
  placeOf(index: number, time: number): Vector3 {
    const { plan, scenario } = this.frame;
    const track = plan?.tracks[index];
    const place = plan && track
      ? placeAt(track.path, plan.perStep, time)
      : point(scenario.vehicles[index]?.start ?? []);
    return new Vector3(...place);
  }

  /** Moves all to the time of a frame that differs from the first in no more than this. */
  moveTo({ time, switches }: SpaceFrame): void {
    const { plan, scenario, highlight } = this.frame;
    this.#tracks.visible = switches.tracks;
    this.#hulls.visible = switches.hulls || plan === null;
    this.#ellipsoids.visible = switches.discs && plan !== null;
    scenario.vehicles.forEach(({ radius, name }, index) => {
      const at = this.placeOf(index, time);
      const grown = radius * (highlight?.vehicles.includes(name) === true ? 1.25 : 1);
      const round = new Matrix4().makeScale(grown, grown, grown).setPosition(at);
      const ellipses = plan?.tracks[index]?.ellipses ?? [];
      const step = Math.min(Math.round(time), Math.max(ellipses.length - 1, 0));
      this.#hulls.setMatrixAt(index, round);
      const disc = ellipsoid(at, ellipses[step], plan?.sigmas ?? 0, radius);
      this.#ellipsoids.setMatrixAt(index, disc);
    });
    this.#hulls.instanceMatrix.needsUpdate = true;
    this.#ellipsoids.instanceMatrix.needsUpdate = true;
  }
}

/** Balls that are seen through everything, each in its color. */
function marks(of: readonly { at: Vector3; radius: number; color: string }[]): InstancedMesh {
  const material = new MeshBasicMaterial({ transparent: true, opacity: 0.7, depthTest: false });
  const mesh = new InstancedMesh(new SphereGeometry(1, 12, 8), material, of.length);
  mesh.frustumCulled = false;
  of.forEach(({ at, radius, color }, index) => {
    mesh.setMatrixAt(index, new Matrix4().makeScale(radius, radius, radius).setPosition(at));
    mesh.setColorAt(index, new Color(color));
  });
  return mesh;
}

/** Where a plan's risk is: a ball at each place, its volume the share of what is allowed. */
export function riskPlaces(plan: PlanView): readonly { line: LedgerLine; at: Vector3; radius: number }[] {
  const largest = largestOf(plan);
  return marksOf(plan).map(({ line, share }) => ({
    line,
    at: new Vector3(...point(line.at)),
    radius: largest * Math.max(Math.cbrt(Math.min(share, 1)), 0.1),
  }));
}

/** Radius of a ball that takes all that is allowed [m]. */
function largestOf({ scenario: { extent } }: PlanView): number {
  return 0.03 * new Vector3(...point(extent.min)).distanceTo(new Vector3(...point(extent.max)));
}

/** The same, drawn in the colors of their causes; those pointed at are seen best. */
export function riskMarks(plan: PlanView, colors: Colors, lit: readonly (readonly number[])[]): InstancedMesh {
  const places = riskPlaces(plan).map(({ line, at, radius }) => ({ at, radius, color: causeColor(line.cause, colors.isDark) }));
  const radius = 0.4 * largestOf(plan);
  const pointed = lit.map((at) => ({ at: new Vector3(...point(at)), radius, color: colors.accent }));
  return marks([...places, ...pointed]);
}

/** Simulated missions as thin lines, those that collide in the color of alarm. */
export function trailLines(trails: TrailsView, colors: Colors): LineSegments2 {
  const paths = trails.trails.flatMap(({ paths: ways, collision }) =>
    ways.map((path) => ({ path, color: collision ? colors.alert : colors.muted })),
  );
  return lines(paths, 1, 0.35);
}

/** Where vehicles were measured in a flight, up to its last tick. */
export function flightLines(flight: FlightState, vehicleColors: readonly string[]): LineSegments2 {
  const count = flight.ticks[0]?.states.length ?? 0;
  const paths = Array.from({ length: count }, (_, index) => ({
    path: flight.ticks.map((tick) => (tick.states[index] ?? []).slice(0, 3)),
    color: vehicleColors[index] ?? "#888888",
  }));
  return lines(paths, 3, 0.8);
}
