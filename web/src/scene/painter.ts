/** Draws the map whenever something that it shows has changed: still layers, then live ones above. */

import type { ReadonlySignal } from "@preact/signals";
import { activeHandle } from "../edit/drag";
import { draft } from "../edit/tools";
import { flight } from "../state/flights";
import { switches } from "../state/layers";
import { compared, isStale, shown, shownTrails } from "../state/plans";
import { drawn, time } from "../state/playback";
import type { ScenarioView } from "../protocol";
import { highlight, hovered, selected } from "../state/selection";
import { theme } from "../state/theme";
import { DARK, LIGHT, vehicleColors } from "./colors";
import type { Frame, Layer } from "./frame";
import { LIVE, STILL } from "./layers/order";
import { camera } from "./viewport";

const NONE: readonly (readonly string[])[] = [];
const names = new WeakMap<ScenarioView["vehicles"], readonly string[]>();

function namesOf(vehicles: ScenarioView["vehicles"]): readonly string[] {
  const known = names.get(vehicles) ?? vehicles.map((vehicle) => vehicle.name);
  names.set(vehicles, known);
  return known;
}

/** Everything that a layer may draw, as it is now. */
export function currentFrame(): Frame {
  const scenario = drawn.value;
  const plan = shown.value;
  const colors = theme.value === "dark" ? DARK : LIGHT;
  const vehicles = scenario?.vehicles ?? [];
  const sets = plan?.sets ?? NONE;
  const scenarioColors = vehicleColors(namesOf(vehicles), sets, colors);
  return {
    camera: camera.value,
    time: time.value,
    colors,
    vehicleColors: plan === null ? scenarioColors : vehicleColors(namesOf(plan.scenario.vehicles), sets, colors),
    scenarioColors,
    scenario,
    plan,
    isStale: isStale.value,
    compared: compared.value,
    trails: shownTrails.value,
    flight: flight.value,
    selected: selected.value,
    hovered: hovered.value,
    highlight: highlight.value,
    draft: draft.value,
    activeHandle: activeHandle.value,
    switches: switches.value,
  };
}

/** Draw into two canvases, one above the other, until told to stop. */
export function paint(still: HTMLCanvasElement, live: HTMLCanvasElement): () => void {
  let isStillDirty = true;
  let request = 0;
  const draw = () => {
    request = 0;
    const frame = currentFrame();
    if (isStillDirty) drawLayers(still, STILL, frame);
    isStillDirty = false;
    drawLayers(live, LIVE, frame);
  };
  const schedule = () => {
    if (request === 0) request = requestAnimationFrame(draw);
  };
  const redraw = () => {
    isStillDirty = true;
    schedule();
  };
  const seldom: readonly ReadonlySignal[] = [
    camera, drawn, shown, isStale, compared, shownTrails, switches, theme, selected,
  ];
  const often: readonly ReadonlySignal[] = [time, flight, hovered, highlight, draft, activeHandle];
  const ends = [
    ...seldom.map((signal) => signal.subscribe(redraw)),
    ...often.map((signal) => signal.subscribe(schedule)),
  ];
  return () => {
    for (const end of ends) end();
    cancelAnimationFrame(request);
  };
}

function drawLayers(canvas: HTMLCanvasElement, layers: readonly Layer[], frame: Frame): void {
  const { width, height } = frame.camera;
  const ratio = window.devicePixelRatio;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const ctx = canvas.getContext("2d");
  if (ctx === null) return;
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.clearRect(0, 0, width, height);
  for (const layer of layers) layer(ctx, frame);
}
