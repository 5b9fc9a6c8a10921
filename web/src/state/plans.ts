/** Plans found, the one on the map, and the one it is compared with. */

import { computed, signal } from "@preact/signals";
import type { PlanSummary, PlanView, ScenarioView, SearchState, TrailsView } from "../protocol";
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

/** Whether what the plan was made for has been changed since. */
export const isStale = computed(() => {
  const plan = shown.value;
  const view = document.value?.view;
  if (plan === null || view === null || view === undefined) return false;
  if (plan.summary.revision === document.value?.revision) return false;
  return essence(plan.scenario) !== essence(view);
});

/** What a plan depends on, but for the bound, which a search may be given for itself. */
function essence(view: ScenarioView): string {
  const { dt, horizon, avoidance, workspace, vehicles, obstacles, ranges } = view;
  return JSON.stringify([dt, horizon, avoidance, workspace, vehicles, obstacles, ranges]);
}

function of<V>(id: string | null, values: ReadonlyMap<string, V>): V | null {
  return id === null ? null : (values.get(id) ?? null);
}
