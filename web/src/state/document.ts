/** The document on the page: its content, its view, what is wrong with it. */

import { batch, computed, signal } from "@preact/signals";
import type { DocumentState, Remark, ScenarioView } from "../protocol";
import { followed } from "./following";
import { hovered, moved, selected, type Thing } from "./selection";

/** The document that is shown. */
export const document = signal<DocumentState | null>(null);

/** Scenario as last understood, with what is being dragged where it is now. */
export const scenario = computed<ScenarioView | null>(() => withEchoes(echoes.value));

/** What the page does to a view before the server knows: what is dragged, and what waits for an answer. */
export interface Echo {
  readonly edit: (view: ScenarioView) => ScenarioView;
  /** Whether the server was told. */
  readonly isSent: boolean;
}

/** In the order in which they came. */
export const echoes = signal<readonly Echo[]>([]);

/** The document's view with what these do to it. */
export function withEchoes(some: readonly Echo[]): ScenarioView | null {
  const view = document.value?.view ?? null;
  return view === null ? null : some.reduce((before, echo) => echo.edit(before), view);
}

/** What is wrong, or worth knowing. */
export const remarks = computed<readonly Remark[]>(() => document.value?.remarks ?? []);

/** Take what the server says unless it is older than what is here. */
export function accept(state: DocumentState): void {
  const known = document.peek();
  if (known?.document !== state.document) {
    batch(() => {
      echoes.value = [];
      document.value = state;
    });
    return;
  }
  if (known.revision > state.revision) return;
  batch(() => {
    if (known.revision < state.revision) follow(known, state);
    document.value = state;
  });
}

/** What is selected stays so, wherever the change has put it; changes are answered in their order. */
function follow(known: DocumentState, state: DocumentState): void {
  const first = echoes.peek().find((echo) => echo.isSent);
  if (first !== undefined) echoes.value = echoes.peek().filter((echo) => echo !== first);
  const now = (thing: Thing | null) => (thing === null ? null : moved(thing, followed(known.content, state.content, thing.path)));
  selected.value = now(selected.peek());
  hovered.value = now(hovered.peek());
}

/** A thing that is held on to while the document changes. */
export class Held {
  #thing: Thing | null;
  #content = document.peek()?.content;

  constructor(thing: Thing) {
    this.#thing = thing;
  }

  /** As it is now; null once it is gone. */
  get thing(): Thing | null {
    const content = document.peek()?.content;
    if (this.#thing !== null && this.#content !== content && this.#content !== undefined && content !== undefined) {
      this.#thing = moved(this.#thing, followed(this.#content, content, this.#thing.path));
    }
    this.#content = content;
    return this.#thing;
  }
}
