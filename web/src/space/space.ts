/**
 * Scenes of three dimensions: the same layers as the map, turned by pointer and keys.
 *
 * A module of its own, loaded where a scene has a third dimension; it shares nothing with the page
 * but the protocol's types, so that notebooks can load it, too. It draws when something changed, and
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

import { Axes } from "./axes.js";
import { Orbit } from "./orbit.js";
import { Solids } from "./solids.js";
import { Fleet, riskMarks, trailLines } from "./tracks.js";
import type { SpaceLook, SpaceScene, SpaceTheme } from "./types.js";

export type { SpaceLook, SpaceScene, SpaceTheme } from "./types.js";

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
  readonly #watch: ResizeObserver;
  #shown: { solids: Solids; fleet: Fleet; axes: Axes; more: Object3D[] } | null = null;
  #told: { scene: SpaceScene; look: SpaceLook; theme: SpaceTheme } | null = null;
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
    this.#stage.addEventListener("keydown", (event) => {
      if (event.key === "0") this.fit();
    });
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(-0.4, -0.7, 1);
    this.#scene.add(new HemisphereLight(0xffffff, 0x8a8a8a, 1.8), sun);
    this.#watch = new ResizeObserver(() => this.#resize());
    this.#watch.observe(host);
    this.#resize();
  }

  /** Where it is looked from [rad]. */
  get direction(): { readonly azimuth: number; readonly elevation: number } {
    return this.#orbit.direction;
  }

  /** Shows a scene; the camera stays while it is the same one. */
  show(scene: SpaceScene, look: SpaceLook, theme: SpaceTheme): void {
    const last = this.#told;
    this.#told = { scene, look, theme };
    const isOther =
      last?.theme !== theme ||
      last.look.marked !== look.marked ||
      last.scene.view !== scene.view ||
      last.scene.plan !== scene.plan ||
      last.scene.other !== scene.other;
    if (isOther) this.#make();
    if (last?.scene.view.name !== scene.view.name) this.fit();
    if (isOther || last.look !== look || last.scene.trails !== scene.trails) this.#dress();
    this.#shown?.fleet.moveTo(look);
    this.#shown?.solids.moveTo(look.time);
    this.#ask();
  }

  /** Shows all of the scene. */
  fit(): void {
    const view = this.#told?.scene.view;
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
    this.#shown = null;
  }

  /** Makes all that stays the same over time. */
  #make(): void {
    if (this.#told === null) return;
    this.#clear();
    const { scene, look, theme } = this.#told;
    const { view } = scene;
    const names = view.vehicles.map(({ name }) => name);
    const solids = new Solids(view, theme, look.marked);
    const fleet = new Fleet(view, scene.plan, scene.other, theme);
    const axes = new Axes(this.#stage, view.workspace ?? view.extent, names, theme);
    this.#shown = { solids, fleet, axes, more: [] };
    this.#scene.background = new Color(theme.background);
    this.#scene.add(solids.group, fleet.group, axes.group);
    this.#stage.ariaLabel = `${view.name} in space, ${names.length} vehicles. ${KEYS}`;
  }

  /** Makes the layers that come and go. */
  #dress(): void {
    if (this.#told === null || this.#shown === null) return;
    const { scene, look, theme } = this.#told;
    for (const thing of this.#shown.more) release(thing);
    const more: Object3D[] = [];
    if (scene.plan && look.risk) more.push(riskMarks(scene.plan, theme, look));
    if (scene.trails && look.trails) more.push(trailLines(scene.trails, theme));
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
    if (this.#shown === null || this.#told === null) return;
    const { fleet, axes } = this.#shown;
    const { scene, look } = this.#told;
    const places = scene.view.vehicles.map((_, index) => fleet.placeOf(index, look.time));
    axes.place(camera, this.host.clientWidth, this.host.clientHeight, places);
  }
}
