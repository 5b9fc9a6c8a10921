/** Plans found, the one on the map, and the one it is compared with. */

import { computed, signal } from "@preact/signals";
import type { PlanSummary, PlanView, SearchState, TrailsView } from "../protocol";
import { document } from "./document";

/** Views by plan, as the server told them. */
export const views = signal<ReadonlyMap<string, PlanView>>(new Map());

/** Simulated missions by plan. */
export const trails = signal<ReadonlyMap<string, TrailsView>>(new Map());

/** Plan to be shown; null is none. */
export const shownId = signal<string | null>(null);

/** Plan to compare it with. */
export const comparedId = signal<string | null>(null);

export const summaries = computed<readonly PlanSummary[]>(() => document.value?.plans ?? []);

export const searches = computed<readonly SearchState[]>(() => document.value?.searches ?? []);

export const shown = computed(() => of(shownId.value, views.value));

export const compared = computed(() => of(comparedId.value, views.value));

export const shownTrails = computed(() => of(shownId.value, trails.value));

function of<V>(id: string | null, values: ReadonlyMap<string, V>): V | null {
  return id === null ? null : (values.get(id) ?? null);
}
