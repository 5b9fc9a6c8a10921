/**
 * Scenes of three dimensions: the same layers as the map, turned by pointer and keys.
 *
 * A module of its own, loaded where a scene has a third dimension; it shares nothing with the page
 * but types and what things are called, so that notebooks can load it, too. It draws when something changed, and
 * then once per frame.
 */

import {
  BufferGeometry,
  Color,
  DirectionalLight,
  HemisphereLight,
  InstancedMesh,
  Material,
  Object3D,
  Scene,
  WebGLRenderer,
} from "three";

import { Axes } from "./axes";
import { Orbit } from "./orbit";
import { Solids } from "./solids";
import { Tip } from "./tip";
import { flightLines, Fleet, riskMarks, trailLines } from "./tracks";
import type { SpaceFrame } from "./types";

export type { SpaceFrame } from "./types";

const KEYS = "Arrows turn, Shift and arrows move, + and − zoom, 0 shows all.";

/** What one thing holds on the graphics processor is given back. */
function release(root: Object3D): void {
  root.traverse((thing) => {
    const { geometry, material } = thing as Partial<{ geometry: unknown; material: unknown }>;
    if (geometry instanceof BufferGeometry) geometry.dispose();
    if (material instanceof Material) material.dispose();
    if (thing instanceof InstancedMesh) thing.dispose();
  });
  root.removeFromParent();
}

/** A view of scenes in space, in an element of the page. */
export class Space {
  /** Frames drawn so far. */
  frames = 0;
  readonly #stage = document.createElement("div");
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #orbit: Orbit;
  readonly #tip: Tip;
  readonly #watch: ResizeObserver;
  #shown: { solids: Solids; fleet: Fleet; axes: Axes; more: Object3D[] } | null = null;
  #frame: SpaceFrame | null = null;
  #request = 0;

  /** Fails where the browser has no WebGL. */
  constructor(readonly host: HTMLElement) {
    this.#renderer = new WebGLRenderer({ antialias: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#stage.className = "space";
    this.#stage.tabIndex = 0;
    this.#stage.setAttribute("role", "application");
    this.#stage.setAttribute("aria-roledescription", "view in space");
    this.#renderer.domElement.ariaHidden = "true";
    this.#stage.append(this.#renderer.domElement);
    host.append(this.#stage);
    this.#orbit = new Orbit(this.#stage, () => this.#ask());
    this.#tip = new Tip(this.#stage, () => this.#ask());
    this.#stage.addEventListener("keydown", (event) => {
      if (event.key === "0") this.fit();
    });
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(-0.4, -0.7, 1);
    this.#scene.add(new HemisphereLight(0xffffff, 0xb4b4b4, 2), sun);
    this.#watch = new ResizeObserver(() => this.#resize());
    this.#watch.observe(host);
    this.#resize();
  }

  /** Where it is looked from [rad]. */
  get direction(): { readonly azimuth: number; readonly elevation: number } {
    return this.#orbit.direction;
  }

  /** Shows a frame; the camera stays while it is the same scene. */
  show(frame: SpaceFrame): void {
    const last = this.#frame;
    this.#frame = frame;
    const differs = (...keys: readonly (keyof SpaceFrame)[]) =>
      last === null || keys.some((key) => last[key] !== frame[key]);
    const isOther = differs("scenario", "plan", "compared", "colors", "highlight");
    if (isOther) this.#make(frame);
    if (isOther || differs("trails", "flight", "switches")) this.#dress(frame);
    if (last?.scenario.name !== frame.scenario.name) this.fit();
    this.#shown?.fleet.moveTo(frame);
    this.#shown?.solids.moveTo(frame.time);
    this.#ask();
  }

  /** Comes nearer by a factor. */
  zoom(factor: number): void {
    this.#orbit.zoom(factor);
  }

  /** Shows all of the scene. */
  fit(): void {
    const view = this.#frame?.scenario;
    if (view) this.#orbit.fit(view.workspace ?? view.extent);
  }

  dispose(): void {
    cancelAnimationFrame(this.#request);
    this.#watch.disconnect();
    this.#orbit.dispose();
    this.#clear();
    this.#renderer.dispose();
    this.#stage.remove();
  }

  #clear(): void {
    if (this.#shown === null) return;
    const { solids, fleet, axes, more } = this.#shown;
    for (const thing of [solids.group, fleet.group, axes.group, ...more]) release(thing);
    axes.dispose();
    solids.dispose();
    this.#shown = null;
  }

  /** Makes all that stays the same over time. */
  #make(frame: SpaceFrame): void {
    this.#clear();
    const { scenario, colors } = frame;
    const names = scenario.vehicles.map(({ name }) => name);
    const solids = new Solids(frame);
    const fleet = new Fleet(frame);
    const axes = new Axes(this.#stage, scenario.workspace ?? scenario.extent, names, colors);
    this.#shown = { solids, fleet, axes, more: [] };
    this.#scene.background = new Color(colors.ground);
    this.#scene.add(solids.group, fleet.group, axes.group);
    this.#stage.ariaLabel = `${scenario.name} in space, ${names.length} vehicles. ${KEYS}`;
  }

  /** Makes the layers that come and go. */
  #dress({ plan, trails, flight, colors, vehicleColors, switches, highlight }: SpaceFrame): void {
    if (this.#shown === null) return;
    for (const thing of this.#shown.more) release(thing);
    const more: Object3D[] = [];
    if (plan && switches.risk) more.push(riskMarks(plan, colors, highlight?.at ?? []));
    if (trails && switches.trails) more.push(trailLines(trails, colors));
    if (flight && switches.flight) more.push(flightLines(flight, vehicleColors));
    this.#shown.more = more;
    if (more.length > 0) this.#scene.add(...more);
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (width === 0 || height === 0) return;
    this.#renderer.setSize(width, height);
    this.#orbit.resize(width, height);
  }

  #ask(): void {
    this.#request ||= requestAnimationFrame(() => {
      this.#request = 0;
      this.#draw();
    });
  }

  #draw(): void {
    const { camera } = this.#orbit;
    this.#renderer.render(this.#scene, camera);
    this.frames += 1;
    if (this.#shown === null || this.#frame === null) return;
    const { solids, fleet, axes } = this.#shown;
    const { scenario, switches, time } = this.#frame;
    const { clientWidth: width, clientHeight: height } = this.host;
    const places = switches.names
      ? scenario.vehicles.map(({ radius }, index) => ({ at: fleet.placeOf(index, time), radius }))
      : [];
    axes.place(camera, width, height, places);
    const placeOf = (index: number) => fleet.placeOf(index, time);
    this.#tip.show({ frame: this.#frame, camera, width, height, placeOf, solids: solids.numbers });
  }
}
