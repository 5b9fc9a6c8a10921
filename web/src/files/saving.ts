/** Opening, saving, dropping files. */

import { signal } from "@preact/signals";
import { attempt, show, showPlan, turnTo } from "../actions";
import { call, CallError } from "../connection";
import { settled } from "../edit/nudge";
import { document } from "../state/document";
import { complain, tell } from "../state/session";

/** Which dialog of files is open. */
export const dialog = signal<"open" | "save" | null>(null);

/** Why the document could not be saved, for the dialog that asks where else, or whether all the same. */
export interface Unsaved {
  readonly text: string;
  /** A file of that name is there, and could be replaced. */
  readonly isThere: boolean;
}

export const unsaved = signal<Unsaved | null>(null);

/** Largest file that may be dropped [bytes]: the server takes no more. */
const MAX_DROP = 4 * 1024 * 1024;

export async function openPath(path: string): Promise<void> {
  const state = await attempt(call("open", { path }));
  if (state === null) return;
  show(state);
  turnTo(state);
  dialog.value = null;
  const last = state.plans.at(-1);
  if (last !== undefined) await showPlan(last.plan);
}

export async function openTemplate(template: string | null): Promise<void> {
  const state = await attempt(call("new", { template }));
  if (state === null) return;
  show(state);
  dialog.value = null;
}

export async function switchTo(id: string): Promise<void> {
  const state = await attempt(call("state", { document: id }));
  if (state === null) return;
  show(state);
  dialog.value = null;
}

/** Save under the name that the document has, or ask for one. */
export async function save(): Promise<void> {
  const state = document.peek();
  if (state === null) return;
  // A file that somebody else has changed meanwhile is not replaced unasked.
  if (state.file === null || !(await saveAs(state.file, false))) dialog.value = "save";
}

/** Save; whether it was done. Why not is kept in `unsaved`. */
export async function saveAs(path: string, overwrite: boolean): Promise<boolean> {
  await settled();
  const state = document.peek();
  if (state === null) return false;
  unsaved.value = null;
  try {
    const saved = await call("save", { document: state.document, path, overwrite });
    // Another may have been opened meanwhile.
    if (document.peek()?.document === saved.document) show(saved);
    tell(`Saved as ${path}`);
    return true;
  } catch (error) {
    const text = error instanceof Error ? error.message : String(error);
    unsaved.value = { text, isThere: error instanceof CallError && error.failure.kind === "exists" };
    return false;
  }
}

/** Open files that were dropped or chosen: charts go into the document that is open. */
export async function take(files: readonly File[]): Promise<void> {
  for (const file of files) {
    if (file.size > MAX_DROP) {
      complain(new Error(`${file.name}: at most 4 MiB can be dropped, got ${(file.size / 2 ** 20).toFixed(1)} MiB`));
      continue;
    }
    const isChart = /\.(geojson|kml)$/i.test(file.name);
    const into = isChart ? (document.peek()?.document ?? null) : null;
    const state = await attempt(call("drop", { name: file.name, content: await file.text(), into }));
    if (state === null) continue;
    show(state);
    dialog.value = null;
    if (!isChart) turnTo(state);
    const last = state.plans.at(-1);
    if (last !== undefined && !isChart) await showPlan(last.plan);
  }
}
