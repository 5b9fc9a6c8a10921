/** Where the map looks: panned, zoomed, fitted, remembered over a reload. */

import { effect, signal } from "@preact/signals";
import { document } from "../state/document";
import { drawn } from "../state/playback";
import type { Box } from "../protocol";
import { Camera } from "./camera";
import { num } from "./geometry";

export const camera = signal(new Camera(0, 0, 10, 1, 1));

/** What looks at the scene instead of the map, while it does: the view in space. */
export const elsewhere = signal<{ zoom(factor: number): void; fit(): void } | null>(null);

/** Left free around what is fitted [px]. */
const MARGIN = 48;

/** Share of the map that an arrow key pans. */
const PAN_SHARE = 0.1;

let fitted: string | null = null;

/** As it showed all last: one that is still so shows all of it in a map of another size, too. */
let whole: Camera | null = null;

export function resize(width: number, height: number): void {
  if (width < 2 || height < 2) return;
  const isWhole = camera.peek() === whole;
  camera.value = camera.peek().resized(width, height);
  if (isWhole) fitAll();
  else settle();
}

export function pan(dx: number, dy: number): void {
  camera.value = camera.peek().panned(dx, dy);
}

export function panBy(right: number, up: number): void {
  const { width, height } = camera.peek();
  pan(-right * PAN_SHARE * width, up * PAN_SHARE * height);
}

/** Zoom about a point of the map's canvas [px]; about its center where there is none. */
export function zoom(factor: number, px?: number, py?: number): void {
  const other = elsewhere.peek();
  if (other !== null) {
    other.zoom(factor);
    return;
  }
  const now = camera.peek();
  camera.value = now.zoomed(factor, px ?? now.width / 2, py ?? now.height / 2);
}

/** Show all of the scenario. */
export function fit(): void {
  elsewhere.peek()?.fit();
  fitAll();
}

function fitAll(): void {
  const extent = drawn.peek()?.extent;
  if (extent !== undefined) fitTo(extent);
}

/** Show a box [m]. */
export function fitTo(box: Box): void {
  const { width, height } = camera.peek();
  const dx = Math.max(num(box.max, 0) - num(box.min, 0), 1e-3);
  const dy = Math.max(num(box.max, 1) - num(box.min, 1), 1e-3);
  const margin = Math.min(MARGIN, width / 8, height / 8);
  const scale = Math.min((width - 2 * margin) / dx, (height - 2 * margin) / dy);
  const x = (num(box.max, 0) + num(box.min, 0)) / 2;
  const y = (num(box.max, 1) + num(box.min, 1)) / 2;
  whole = new Camera(x, y, scale, width, height);
  camera.value = whole;
}

/** Bring a place into view without zooming, where it is not. */
export function reveal(x: number, y: number): void {
  const now = camera.peek();
  const [px, py] = now.toScreen(x, y);
  if (px > MARGIN && py > MARGIN && px < now.width - MARGIN && py < now.height - MARGIN) return;
  camera.value = new Camera(x, y, now.scale, now.width, now.height);
}

/** Look where the page looked before a reload, or at all of a document that is new to it. */
function settle(): void {
  const id = document.peek()?.document;
  if (id === undefined || drawn.peek() === null || fitted === id || camera.peek().width < 2) return;
  fitted = id;
  const kept = sessionStorage.getItem(`camera ${id}`);
  const [x, y, scale] = kept === null ? [] : (JSON.parse(kept) as number[]);
  const { width, height } = camera.peek();
  if (x === undefined || y === undefined || scale === undefined) fit();
  else camera.value = new Camera(x, y, scale, width, height);
}

/** Fit documents as they come, and remember the camera of each; called once. */
export function watch(): void {
  effect(() => {
    if (document.value !== null && drawn.value !== null) settle();
  });
  let timer = 0;
  effect(() => {
    const { x, y, scale } = camera.value;
    clearTimeout(timer);
    timer = window.setTimeout(() => {
      if (fitted !== null) sessionStorage.setItem(`camera ${fitted}`, JSON.stringify([x, y, scale]));
    }, 200);
  });
}
