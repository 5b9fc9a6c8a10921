/** Mouse, pen and fingers on the map: pan, zoom, select, drag, draw. */

import { signal } from "@preact/signals";
import { activeHandle, decimals, Drag, rounded } from "../edit/drag";
import { insertAt } from "../edit/corners";
import { pick } from "../edit/create";
import * as tools from "../edit/tools";
import { hovered, sameThing } from "../state/selection";
import { FINGER, gripAt, MOUSE, thingAt } from "./hits";
import { currentFrame } from "./painter";
import { camera, pan, zoom } from "./viewport";

/** A press that moves less is a click [px]. */
const CLICK = 4;

/** Where the pointer is on the map [m], and on the canvas [px]; null is elsewhere. */
export const pointer = signal<{ readonly place: readonly [number, number]; readonly px: number; readonly py: number } | null>(
  null,
);

/** Zoom of a notch of the wheel. */
const WHEEL = 0.0015;

interface Press {
  readonly id: number;
  readonly startX: number;
  readonly startY: number;
  /** null pans. */
  readonly grip: Drag | null;
  lastX: number;
  lastY: number;
  isClick: boolean;
}

/** Listen to the canvas until told to stop. */
export function listenTo(canvas: HTMLElement): () => void {
  const fingers = new Map<number, { x: number; y: number }>();
  let press: Press | null = null;

  const at = (event: PointerEvent | WheelEvent | MouseEvent): [number, number] => {
    const bounds = canvas.getBoundingClientRect();
    return [event.clientX - bounds.left, event.clientY - bounds.top];
  };

  const drop = () => {
    press?.grip?.drop();
    press = null;
  };

  const down = (event: PointerEvent) => {
    const [px, py] = at(event);
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: px, y: py });
    if (fingers.size > 1) {
      drop();
      return;
    }
    if (event.button > 1) return;
    const isFree = tools.tool.peek() === "select" && event.button === 0;
    const grip = isFree ? gripAt(currentFrame(), px, py, reachOf(event)) : null;
    const held = grip === null ? null : new Drag(grip.thing, grip.index);
    press = { id: event.pointerId, startX: px, startY: py, grip: held, lastX: px, lastY: py, isClick: true };
  };

  const move = (event: PointerEvent) => {
    const [px, py] = at(event);
    pointer.value = { place: roundPlace(px, py), px, py };
    const finger = fingers.get(event.pointerId);
    if (fingers.size === 2 && finger !== undefined) {
      pinch(fingers, event.pointerId, px, py);
      return;
    }
    if (press === null) {
      hoverOver(canvas, px, py, reachOf(event));
      return;
    }
    if (Math.hypot(px - press.startX, py - press.startY) > CLICK) press.isClick = false;
    if (!press.isClick) drag(press, px, py, event.shiftKey);
    press.lastX = px;
    press.lastY = py;
  };

  const up = (event: PointerEvent) => {
    fingers.delete(event.pointerId);
    if (press?.id !== event.pointerId) return;
    const { grip, isClick } = press;
    const [px, py] = at(event);
    press = null;
    if (isClick && event.button === 0) click(px, py, reachOf(event));
    else void grip?.finish();
  };

  const cancelled = (event: PointerEvent) => {
    fingers.delete(event.pointerId);
    drop();
  };

  /** Escape in the middle of a drag puts back what is dragged. */
  const key = (event: KeyboardEvent) => {
    if (event.key !== "Escape" || press === null || press.isClick) return;
    drop();
    event.preventDefault();
    event.stopPropagation();
  };

  const wheel = (event: WheelEvent) => {
    event.preventDefault();
    const [px, py] = at(event);
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    // Touch pads tell a pinch as a wheel with Control, in small amounts.
    const factor = event.ctrlKey ? 6 : 1;
    zoom(Math.exp(-event.deltaY * lines * WHEEL * factor), px, py);
  };

  const leave = () => {
    pointer.value = null;
    hovered.value = null;
    tools.hover(null);
  };

  const doubled = (event: MouseEvent) => {
    const [px, py] = at(event);
    if (tools.tool.peek() !== "select") tools.end();
    else void insertAt(roundPlace(px, py), MOUSE / camera.peek().scale);
  };

  canvas.addEventListener("pointerdown", down);
  canvas.addEventListener("pointermove", move);
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", cancelled);
  canvas.addEventListener("pointerleave", leave);
  canvas.addEventListener("dblclick", doubled);
  canvas.addEventListener("wheel", wheel, { passive: false });
  window.addEventListener("keydown", key, true);
  return () => {
    canvas.removeEventListener("pointerdown", down);
    canvas.removeEventListener("pointermove", move);
    canvas.removeEventListener("pointerup", up);
    canvas.removeEventListener("pointercancel", cancelled);
    canvas.removeEventListener("pointerleave", leave);
    canvas.removeEventListener("dblclick", doubled);
    canvas.removeEventListener("wheel", wheel);
    window.removeEventListener("keydown", key, true);
  };
}

function reachOf(event: PointerEvent): number {
  return event.pointerType === "touch" ? FINGER : MOUSE;
}

/** A place under the pointer, on a round number [m]. */
function roundPlace(px: number, py: number): [number, number] {
  const now = camera.peek();
  const digits = decimals(now.scale);
  const [x, y] = now.toMap(px, py);
  return [Number(x.toFixed(digits)), Number(y.toFixed(digits))];
}

function click(px: number, py: number, reach: number): void {
  if (tools.tool.peek() !== "select") {
    tools.place(roundPlace(px, py));
    return;
  }
  const frame = currentFrame();
  const grip = gripAt(frame, px, py, reach);
  if (grip !== null && sameThing(grip.thing, frame.selected)) activeHandle.value = grip.index;
  else pick(grip?.thing ?? thingAt(frame, px, py, reach));
}

function drag(press: Press, px: number, py: number, isStraight: boolean): void {
  const { grip } = press;
  if (grip === null) {
    pan(px - press.lastX, py - press.lastY);
    return;
  }
  const { handle, thing, index } = grip;
  if (handle === undefined || thing === null) return;
  const { scale } = camera.peek();
  let dx = (px - press.startX) / scale;
  let dy = (press.startY - py) / scale;
  if (isStraight && Math.abs(dx) > Math.abs(dy)) dy = 0;
  else if (isStraight) dx = 0;
  if (activeHandle.peek() !== index || !sameThing(thing, currentFrame().selected)) {
    pick(thing);
    activeHandle.value = index;
  }
  grip.show(...rounded(handle, dx, dy, decimals(scale)));
}

function hoverOver(canvas: HTMLElement, px: number, py: number, reach: number): void {
  if (tools.tool.peek() !== "select") {
    tools.hover(roundPlace(px, py));
    canvas.style.cursor = "crosshair";
    return;
  }
  const frame = currentFrame();
  const grip = gripAt(frame, px, py, reach);
  const thing = grip?.thing ?? thingAt(frame, px, py, reach);
  if (!sameThing(thing, hovered.peek())) hovered.value = thing;
  canvas.style.cursor = grip !== null ? "move" : thing !== null ? "pointer" : "grab";
}

/** Two fingers: their middle pans, their distance zooms. */
function pinch(fingers: Map<number, { x: number; y: number }>, id: number, px: number, py: number): void {
  const moving = fingers.get(id);
  const other = [...fingers].find(([key]) => key !== id)?.[1];
  if (moving === undefined || other === undefined) return;
  const before = Math.hypot(moving.x - other.x, moving.y - other.y);
  const after = Math.hypot(px - other.x, py - other.y);
  pan((px - moving.x) / 2, (py - moving.y) / 2);
  if (before > 1 && after > 1) zoom(after / before, (px + other.x) / 2, (py + other.y) / 2);
  moving.x = px;
  moving.y = py;
}
