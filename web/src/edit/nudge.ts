/** Arrow keys on what is selected: shown at once, told to the server when the keys rest. */

import { document } from "../state/document";
import { selected, type Thing } from "../state/selection";
import { camera, reveal } from "../scene/viewport";
import { activeHandle, decimals, finish, show } from "./drag";
import { clean } from "./paths";
import { handlesOf } from "./things";

/** Keys that follow one another this soon are one change [ms]. */
const REST = 500;

interface Nudge {
  readonly thing: Thing;
  readonly index: number;
  readonly dx: number;
  readonly dy: number;
}

let pending: Nudge | null = null;
let timer = 0;

/** Move the active handle of the selected thing by one round step; false where there is none. */
export function nudge(right: number, up: number, factor: number): boolean {
  const view = document.peek()?.view;
  const thing = selected.peek();
  if (view == null || thing === null) return false;
  const index = activeHandle.peek();
  const handle = handlesOf(view, thing)[index];
  if (handle === undefined) return false;
  const step = factor * 10 ** -decimals(camera.peek().scale);
  const before = pending?.thing === thing && pending.index === index ? pending : { dx: 0, dy: 0 };
  pending = { thing, index, dx: clean(before.dx + right * step), dy: clean(before.dy + up * step) };
  show(thing, index, pending.dx, pending.dy);
  reveal((handle.at[0] ?? 0) + pending.dx, (handle.at[1] ?? 0) + pending.dy);
  clearTimeout(timer);
  timer = window.setTimeout(() => void settle(), REST);
  return true;
}

/** Tell the server what the keys did so far. */
export async function settle(): Promise<void> {
  clearTimeout(timer);
  const done = pending;
  pending = null;
  if (done !== null) await finish(done.thing, done.index, done.dx, done.dy);
}
