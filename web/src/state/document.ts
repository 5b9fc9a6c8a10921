/** The document on the page: its content, its view, what is wrong with it. */

import { computed, signal } from "@preact/signals";
import type { DocumentState, Remark, ScenarioView } from "../protocol";

/** The document that is shown. */
export const document = signal<DocumentState | null>(null);

/** Scenario as last understood, with what is being dragged where it is now. */
export const scenario = computed<ScenarioView | null>(() => echo.value ?? document.value?.view ?? null);

/** The scenario in the middle of a drag, before the server knows. */
export const echo = signal<ScenarioView | null>(null);

/** What is wrong, or worth knowing. */
export const remarks = computed<readonly Remark[]>(() => document.value?.remarks ?? []);

/** Take what the server says unless it is older than what is here. */
export function accept(state: DocumentState): void {
  const known = document.peek();
  if (known?.document === state.document && known.revision > state.revision) return;
  echo.value = null;
  document.value = state;
}
