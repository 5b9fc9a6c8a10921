/** Arrow keys on what is selected: shown at once, told to the server when the keys rest. */

import { idle } from "../actions";
import { scenario } from "../state/document";
import { sameThing, selected } from "../state/selection";
import { camera, reveal } from "../scene/viewport";
import { activeHandle, decimals, Drag } from "./drag";
import { clean } from "./paths";
import { handlesOf } from "./things";

/** Keys that follow one another this soon are one change [ms]. */
const REST = 500;

let pending: Drag | null = null;
let timer = 0;

/** Move the active handle of the selected thing by one round step; false where there is none. */
export function nudge(right: number, up: number, factor: number): boolean {
  const view = scenario.peek();
  const thing = selected.peek();
  if (view === null || thing === null) return false;
  const index = activeHandle.peek();
  const handle = handlesOf(view, thing)[index];
  if (handle === undefined) return false;
  const step = factor * 10 ** -decimals(camera.peek().scale);
  if (pending !== null && !(sameThing(pending.thing, thing) && pending.index === index)) void settle();
  pending ??= new Drag(thing, index);
  const [dx, dy] = pending.by;
  pending.show(clean(dx + right * step), clean(dy + up * step));
  reveal((handle.at[0] ?? 0) + right * step, (handle.at[1] ?? 0) + up * step);
  clearTimeout(timer);
  timer = window.setTimeout(() => void settle(), REST);
  return true;
}

/** Tell the server what the keys did so far. */
export async function settle(): Promise<void> {
  clearTimeout(timer);
  const done = pending;
  pending = null;
  await done?.finish();
}

/** Ask for something after what the keys did so far: changes are made in the order in which they are asked for. */
export function after(ask: () => Promise<unknown>): void {
  void settle();
  void ask();
}

/** Once the server has all that was done so far. */
export async function settled(): Promise<void> {
  await settle();
  await idle();
}
