/** What the panels ask the server for, and what they keep between one drawing and the next. */

import { computed, effect, signal, type Signal } from "@preact/signals";
import { attempt, simulate, showPlan, takeFlight, takeSearch } from "../actions";
import { call, line } from "../connection";
import { settled } from "../edit/nudge";
import type { Remark, SearchState } from "../protocol";
import { document, remarks, scenario } from "../state/document";
import { flight, flightId, flights } from "../state/flights";
import { searches, shown, shownId } from "../state/plans";
import { dt, isFollowing, isPlaying, seek } from "../state/playback";
import { tell } from "../state/session";
import type { FlightOrder } from "./flight";
import { isPointing } from "./pointing";
import type { Moment, Wishes } from "./search";

export const wishes = signal<Wishes>({ planner: "certified", seconds: 60, gap: null });

/** How the next plan is to be flown. */
export const order = signal<FlightOrder>({ seed: 0, pace: 5, replans: true, log: "" });

/** Δ of the next search where it is not the scenario's. */
export const chosenBound = signal<number | null>(null);

/** Δ of the next search. */
export const nextBound = computed(() => chosenBound.value ?? scenario.value?.riskBound ?? 0.01);

/** Vehicle whose risk is listed; null is all of them. */
export const riskVehicle = signal<string | null>(null);

export const isSimulating = signal(false);

/** The search to be watched: one that runs, else the last. */
export const search = computed<SearchState | null>(() => {
  const all = searches.value;
  return all.findLast((one) => one.state === "running" || one.state === "paused") ?? all.at(-1) ?? null;
});

/** Why nothing can be planned now. */
export const refusal = computed<string | null>(() => {
  if (line.value !== "open") return "There is no connection.";
  if (document.value === null) return "Nothing is open.";
  if (remarks.value.some((remark) => remark.severity === "error")) return "The scenario has errors; see Scene.";
  return scenario.value?.vehicles.length === 0 ? "There is no vehicle yet." : null;
});

const NO_MOMENTS: readonly Moment[] = [];
const courses = signal<ReadonlyMap<string, readonly Moment[]>>(new Map());

/** Cost and bound of the search that is watched, as far as this page was told. */
export const moments = computed(() => courses.value.get(search.value?.search ?? "") ?? NO_MOMENTS);

/** Keep what a search is told to have found, whenever it is news. */
function keepMoments(): void {
  const now = search.value;
  if (now === null || (now.cost === null && now.bound === null)) return;
  const course = courses.peek().get(now.search) ?? NO_MOMENTS;
  if (course.at(-1)?.seconds === now.seconds) return;
  const moment = { seconds: now.seconds, cost: now.cost, bound: now.bound };
  courses.value = new Map(courses.peek()).set(now.search, [...course, moment]);
}

const asked = signal<{ readonly key: string; readonly remarks: readonly Remark[] } | null>(null);

export const isLooking = signal(false);

const revisionKey = computed(() => `${document.value?.document ?? ""} ${document.value?.revision ?? 0}`);

const NO_REMARKS: readonly Remark[] = [];

/** Remarks on the scenario, on the plan shown, and what trying cures told; each once. */
export const reasons = computed<readonly Remark[]>(() => {
  const found = asked.value?.key === revisionKey.value ? asked.value.remarks : NO_REMARKS;
  const plan = shown.value;
  const isNew = plan?.summary.revision === document.value?.revision;
  const all = [...remarks.value, ...(isNew ? (plan?.remarks ?? NO_REMARKS) : NO_REMARKS), ...found];
  // The same words come with cures where these are known.
  const byText = new Map<string, Remark>();
  for (const remark of all) {
    if (remark.cures.length > 0 || !byText.has(remark.text)) byText.set(remark.text, remark);
  }
  return [...byText.values()];
});

/** How the search ended that found nothing, and what is said of a plan that does not hold. */
export const tried = computed<readonly string[]>(() => {
  const sentences: string[] = [];
  const last = search.value;
  if (last?.note != null && (last.state === "failed" || (last.state === "ended" && last.found === 0))) sentences.push(last.note);
  const summary = shown.value?.summary;
  if (summary?.holds === false && summary.explanation !== null) sentences.push(summary.explanation);
  return [...new Set(sentences)];
});

export async function look(): Promise<void> {
  const id = document.peek()?.document;
  if (id === undefined) return;
  isLooking.value = true;
  await settled();
  const key = revisionKey.peek();
  const found = await attempt(call("why", { document: id }));
  isLooking.value = false;
  if (found === null) return;
  asked.value = { key, remarks: found };
  if (found.length === 0) tell("Nothing was found to stand in the way.");
}

/** Run what is asked for unless it is being asked for already, as by the second of two clicks. */
export async function once(is: Signal<boolean>, run: () => Promise<void>): Promise<void> {
  if (is.peek()) return;
  is.value = true;
  try {
    await run();
  } finally {
    is.value = false;
  }
}

/** Whether a search, a flight has been asked for and not begun yet. */
export const isStarting = { search: signal(false), flight: signal(false) };

export async function startSearch(): Promise<void> {
  await settled();
  const id = document.peek()?.document;
  if (id === undefined) return;
  const { planner, seconds, gap } = wishes.peek();
  const state = await attempt(call("plan", { document: id, planner, seconds, gap, riskBound: chosenBound.peek() }));
  if (state !== null) takeSearch(state);
}

export async function steer(what: "pause" | "resume" | "stop"): Promise<void> {
  const id = search.peek()?.search;
  if (id !== undefined) await attempt(call(what, { search: id }));
}

export async function savePlan(plan: string, path: string, overwrite: boolean): Promise<void> {
  const done = await attempt(call("savePlan", { plan, path, overwrite }).then(() => true));
  if (done === true) tell(`Saved as ${path}`);
}

export async function exportPlan(plan: string, format: string): Promise<void> {
  const file = await attempt(call("export", { plan, format }));
  if (file === null) return;
  const bytes = Uint8Array.from(atob(file.base64), (letter) => letter.charCodeAt(0));
  const link = window.document.createElement("a");
  link.href = URL.createObjectURL(new Blob([bytes]));
  link.download = file.name;
  link.click();
  URL.revokeObjectURL(link.href);
  tell([`Exported ${file.name}`, ...file.warnings.map((warning) => `Warning: ${warning}`)].join(". "));
}

export async function runSimulation(plan: string, flights: number, seed: number): Promise<void> {
  isSimulating.value = true;
  await simulate(plan, flights, seed);
  isSimulating.value = false;
}

/** Longest time between ticks that is asked for [s]. */
const SLOWEST = 60;

/** Least time that a decision is given [s]: with less nothing new is ever planned. */
const DECISION = 0.5;

export async function startFlight(plan: string): Promise<void> {
  const { seed, pace: faster, replans, log } = order.peek();
  const pace = faster === 0 ? 0 : Math.min(dt.peek() / faster, SLOWEST);
  const deadline = Math.max(pace, DECISION);
  const options = { replan: replans ? "certified" : "none", deadline, ...(log.trim() === "" ? {} : { log: log.trim() }) };
  const state = await attempt(call("fly", { plan, seed, pace, options }));
  if (state === null) return;
  takeFlight(state);
  isFollowing.value = true;
  flightId.value = state.flight;
  seek(0);
}

export async function stopFlight(id: string): Promise<void> {
  await attempt(call("stopFlight", { flight: id }));
}

export function chooseFlight(id: string | null): void {
  flightId.value = id;
  const plan = flights.peek().find((one) => one.flight === id)?.plan ?? null;
  if (plan !== null && plan !== shownId.peek()) void showPlan(plan);
}

/** Let panels follow what the server tells; called once. */
export function follow(): void {
  effect(keepMoments);
  let told = 0;
  let toldOf: string | undefined;
  effect(() => {
    const all = flights.value;
    const id = document.value?.document;
    // Another document has flights of its own.
    if (id !== toldOf) told = 0;
    toldOf = id;
    const isKnown = all.some((one) => one.flight === flightId.peek());
    if (all.length > told && !isKnown) chooseFlight(all.at(-1)?.flight ?? null);
    told = all.length;
  });
  effect(() => {
    const now = flight.value;
    if (now?.state !== "running" || !isFollowing.value || isPointing()) return;
    isPlaying.value = false;
    seek(now.step);
  });
  // Another document has its own Δ.
  let before: string | undefined;
  effect(() => {
    const id = document.value?.document;
    if (id !== before) chosenBound.value = null;
    before = id;
  });
}
