/** Keys of the page, and keys of the map. */

import { redo, undo } from "../actions";
import { save } from "../files/saving";
import { helpIsOpen } from "../state/session";
import { selected } from "../state/selection";
import { drawn, goTo, togglePlaying } from "../state/playback";
import { camera, fit, panBy, zoom } from "../scene/viewport";
import { insertCorner, removeCorner } from "./corners";
import { remove, pick } from "./create";
import { activeHandle, decimals } from "./drag";
import { after, nudge, settle } from "./nudge";
import { handlesOf } from "./things";
import * as tools from "./tools";

const TOOLS: Readonly<Record<string, tools.Tool>> = {
  v: "select", n: "vehicle", w: "waypoint", p: "polygon", b: "box", l: "line",
};

const ARROWS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
};

/** How far an arrow key moves the cross of a tool [px]. */
const CROSS = 10;

/** All keys in words, for the help. */
export const KEYS: readonly (readonly [string, string])[] = [
  ["V", "Select"],
  ["N", "New vehicle: start, then goal"],
  ["W", "Waypoint of the selected vehicle"],
  ["P, B, L", "Obstacle: polygon, box, line"],
  ["Arrows", "Pan the map, or move what is selected, or the cross of a tool"],
  ["Shift + arrows", "Ten times as far"],
  ["Alt + arrows", "Pan, whatever is selected"],
  ["[ and ]", "Previous, next handle of what is selected"],
  ["Enter", "Set a point; with nothing new to set, end the outline"],
  ["Backspace", "Take back the last point; remove the chosen corner of an obstacle"],
  ["Insert, double click", "A new corner after the chosen one; on the edge"],
  ["Delete", "Remove what is selected"],
  ["Escape", "Drop what is being drawn or dragged; let go of what is selected"],
  ["+ and −", "Zoom"],
  ["F", "Show all"],
  ["Space", "Play and pause"],
  ["Home, End", "To the start, to the end of the mission"],
  ["Ctrl + Z, Ctrl + Shift + Z", "Undo, redo"],
  ["Ctrl + S", "Save"],
];

/** Fields into which nothing is typed. */
const POINTED = "input[type=checkbox], input[type=radio], input[type=range]";

function isTyping({ target }: KeyboardEvent): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target.closest("textarea, select, dialog, [contenteditable]") !== null) return true;
  return target.closest("input") !== null && !target.matches(POINTED);
}

/** Take what is being typed, as leaving the field would. */
function takeTyped(): void {
  const field = document.activeElement;
  if (!(field instanceof HTMLInputElement)) return;
  field.blur();
  field.focus({ preventScroll: true });
}

/** Keys that work everywhere on the page; called once. */
export function listenToKeys(): void {
  window.addEventListener("keydown", (event) => {
    if (event.defaultPrevented) return;
    if (event.ctrlKey || event.metaKey ? command(event) : !event.altKey && !isTyping(event) && plain(event)) {
      event.preventDefault();
    }
  });
}

function command(event: KeyboardEvent): boolean {
  const key = event.key.toLowerCase();
  if (key === "s") {
    takeTyped();
    void save();
    return true;
  }
  // In a field, undo is that of the field.
  if (isTyping(event)) return false;
  if (key === "z" && !event.shiftKey) after(undo);
  else if (key === "y" || key === "z") after(redo);
  else return false;
  return true;
}

function plain(event: KeyboardEvent): boolean {
  const name = TOOLS[event.key.toLowerCase()];
  if (name !== undefined) {
    tools.choose(name);
    if (name !== "select") {
      document.getElementById("map")?.focus();
      const { x, y } = camera.peek();
      tools.hover(roundAt(x, y));
    }
    return true;
  }
  switch (event.key) {
    case "Escape":
      if (tools.tool.peek() === "select") pick(null);
      else tools.cancel();
      return true;
    case "Delete": {
      const thing = selected.peek();
      if (thing === null) return false;
      after(() => remove(thing));
      return true;
    }
    case "?":
      helpIsOpen.value = true;
      return true;
    case " ":
      // Buttons, boxes and lists do something else with it.
      if (event.target instanceof HTMLElement && event.target.closest("button, summary, a, input, [role=option]") !== null) return false;
      togglePlaying();
      return true;
    default:
      return event.key.toLowerCase() === "f" ? (fit(), true) : false;
  }
}

/** Keys while the map has the focus. */
export function keyOnMap(event: KeyboardEvent): void {
  if (event.ctrlKey || event.metaKey || event.target !== event.currentTarget) return;
  if (arrow(event) || other(event)) {
    event.preventDefault();
    event.stopPropagation();
  }
}

function arrow(event: KeyboardEvent): boolean {
  const direction = ARROWS[event.key];
  if (direction === undefined) return false;
  const [right, up] = direction;
  const factor = event.shiftKey ? 10 : 1;
  if (event.altKey) panBy(right, up);
  else if (tools.tool.peek() !== "select") moveCross(right * factor, up * factor);
  else if (!nudge(right, up, factor)) panBy(right, up);
  return true;
}

function moveCross(right: number, up: number): void {
  const now = camera.peek();
  const [x, y] = tools.draft.peek()?.cursor ?? [now.x, now.y];
  tools.hover(roundAt(x + (right * CROSS) / now.scale, y + (up * CROSS) / now.scale));
}

function roundAt(x: number, y: number): [number, number] {
  const digits = decimals(camera.peek().scale);
  return [Number(x.toFixed(digits)), Number(y.toFixed(digits))];
}

function other(event: KeyboardEvent): boolean {
  switch (event.key) {
    case "Enter":
      return enter();
    case "Backspace":
      if (tools.tool.peek() === "select") after(removeCorner);
      else tools.takeBack();
      return true;
    case "+":
    case "=":
      zoom(1.25);
      return true;
    case "-":
      zoom(0.8);
      return true;
    case "Home":
      goTo(0);
      return true;
    case "End":
      goTo(Infinity);
      return true;
    case "Insert":
      after(insertCorner);
      return true;
    case "[":
    case "]":
      turn(event.key === "]" ? 1 : -1);
      return true;
    default:
      return false;
  }
}

/** Set a point at the cross; on the point that was set last, end. */
function enter(): boolean {
  const now = tools.draft.peek();
  if (now === null) return false;
  const last = now.points.at(-1);
  const { cursor } = now;
  if (cursor === null || (last !== undefined && last[0] === cursor[0] && last[1] === cursor[1])) tools.end();
  else tools.place(cursor);
  return true;
}

/** Choose another handle of what is selected. */
function turn(by: number): void {
  const scenario = drawn.peek();
  const thing = selected.peek();
  if (scenario === null || thing === null) return;
  const handles = handlesOf(scenario, thing);
  const index = (activeHandle.peek() + by + handles.length) % Math.max(handles.length, 1);
  void settle();
  activeHandle.value = index;
  const at = handles[index]?.at;
  if (at !== undefined) tools.announce(`Handle ${index + 1} of ${handles.length} at ${at.join(", ")} m`);
}
