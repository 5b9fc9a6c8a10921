/** What an operator can ask the server for; what it refuses is told in a notice. */

import { batch } from "@preact/signals";
import { call, CallError, connect, listen, onOpen } from "./connection";
import type { Change, DocumentState, Event, FlightState, PlanView, SearchState } from "./protocol";
import { accept, document } from "./state/document";
import { comparedId, shownId, summaries, trails, views } from "./state/plans";
import { seek } from "./state/playback";
import { kept } from "./state/restore";
import { selected } from "./state/selection";
import { complain, hello, judging, tab } from "./state/session";

/** Say hello, and take up the document that was shown before a reload or a loss. */
async function greet(): Promise<void> {
  const isBack = hello.peek() !== null;
  const shown = document.peek()?.document;
  const wanted = shown ?? sessionStorage.getItem("document");
  hello.value = await call("hello", {});
  const known = hello.value.documents.find((candidate) => candidate.document === wanted);
  const id = known?.document ?? hello.value.document;
  if (id === null) return;
  const before = isBack ? null : kept();
  const state = await call("state", { document: id });
  // What was opened meanwhile stays.
  if (document.peek()?.document !== shown) return;
  show(state);
  if (!isBack && before === null) turnTo(state);
  if (before === null || id !== wanted) await showNewest();
  else await takeUp(before);
}

/** Show again what was selected and shown before a reload. */
async function takeUp(before: NonNullable<ReturnType<typeof kept>>): Promise<void> {
  selected.value = before.selected;
  const isThere = summaries.peek().some((plan) => plan.plan === before.shown);
  if (before.shown !== null && isThere) await showPlan(before.shown);
  else await showNewest();
  seek(before.time);
}

/** Show the plan found last, where none is shown. */
async function showNewest(): Promise<void> {
  const last = summaries.peek().at(-1);
  if (shownId.peek() === null && last !== undefined) await showPlan(last.plan);
}

/** Turn to the panel of what a file brought along: its flight, or its plan. */
export function turnTo({ flights, plans }: DocumentState): void {
  if (flights.length > 0) tab.value = "flight";
  else if (plans.length > 0) tab.value = "plan";
}

/** Put a document on the page. */
export function show(state: DocumentState): void {
  batch(() => {
    if (document.peek()?.document !== state.document) {
      selected.value = null;
      comparedId.value = null;
      shownId.value = null;
    }
    accept(state);
  });
  sessionStorage.setItem("document", state.document);
}

/** Run a call for its effect; what it is refused for is told. */
export async function attempt<T>(promise: Promise<T>): Promise<T | null> {
  try {
    return await promise;
  } catch (error) {
    complain(error);
    return null;
  }
}

/** Changes wait for one another, as each is made to the revision that the one before leaves. */
let last: Promise<unknown> = Promise.resolve();

function next(make: (state: DocumentState) => Promise<DocumentState> | null): Promise<boolean> {
  const done = last.then(async () => {
    const state = document.peek();
    const asked = state === null ? null : make(state);
    if (asked === null) return false;
    try {
      accept(await asked);
      return true;
    } catch (error) {
      await refused(error);
      return false;
    }
  });
  last = done;
  return done;
}

/** What was changed on another page is fetched, so that the operator sees to what it was changed. */
async function refused(error: unknown): Promise<void> {
  const state = document.peek();
  if (!(error instanceof CallError) || error.failure.kind !== "stale" || state === null) {
    complain(error);
    return;
  }
  complain(new Error("Changed on another page meanwhile; look at it, then do it again"));
  const newest = await attempt(call("state", { document: state.document }));
  if (newest !== null) accept(newest);
}

/** Change the document: one step of undo, named by `label`. */
export function change(changes: readonly Change[], label: string): Promise<boolean> {
  return next(({ document: id, revision }) => call("change", { document: id, revision, changes, label }));
}

export function undo(): Promise<boolean> {
  return next(({ document: id, revision, canUndo }) => (canUndo ? call("undo", { document: id, revision }) : null));
}

export function redo(): Promise<boolean> {
  return next(({ document: id, revision, canRedo }) => (canRedo ? call("redo", { document: id, revision }) : null));
}

/** Show a plan on the map. */
export async function showPlan(plan: string | null, isNews = false): Promise<void> {
  if (plan !== null) await loadPlan(plan, isNews);
  shownId.value = plan;
}

/** Compare the plan shown with another. */
export async function comparePlan(plan: string | null): Promise<void> {
  if (plan !== null) await loadPlan(plan);
  comparedId.value = plan;
}

async function loadPlan(plan: string, isNews = false): Promise<PlanView | null> {
  const known = isNews ? undefined : views.peek().get(plan);
  if (known !== undefined) return known;
  const view = await attempt(call("view", { plan }));
  if (view !== null) views.value = new Map(views.peek()).set(plan, view);
  return view;
}

/** Simulate missions of a plan. */
export async function simulate(plan: string, flights: number, seed: number): Promise<void> {
  const view = await attempt(call("simulate", { plan, flights, seed }));
  if (view !== null) trails.value = new Map(trails.peek()).set(plan, view);
}

function withSearch(state: DocumentState, search: SearchState): DocumentState {
  const others = state.searches.filter((other) => other.search !== search.search);
  return { ...state, searches: [...others, search] };
}

function hear(event: Event): void {
  if (event.event === "judging") judging.value = event.state.isOver ? null : event.state;
  const state = document.peek();
  if (state === null) return;
  switch (event.event) {
    case "document":
      if (event.state.document === state.document) accept(event.state);
      break;
    case "search":
      if (event.state.document === state.document) document.value = withSearch(state, event.state);
      break;
    case "plan":
      if (event.document === state.document) hearPlan(state, event);
      break;
    case "flight":
      takeFlight(event.state);
      break;
    case "tick":
      hearTick(state, event);
      break;
  }
}

/** Take a flight as the server has it, unless more of it is known here. */
export function takeFlight(flight: FlightState): void {
  const state = document.peek();
  if (state?.document !== flight.document) return;
  const known = state.flights.find((other) => other.flight === flight.flight);
  if (known !== undefined && flight.state === "running" && known.ticks.length > flight.ticks.length) return;
  const others = state.flights.filter((other) => other !== known);
  document.value = { ...state, flights: [...others, flight] };
}

/** A tick follows those that are known; of a flight that is not, all of it is asked for. */
function hearTick(state: DocumentState, { flight, tick }: Extract<Event, { event: "tick" }>): void {
  if (!state.flights.some((known) => known.flight === flight)) {
    void call("flight", { flight }).then(takeFlight, () => undefined);
    return;
  }
  const flights = state.flights.map((known) => {
    if (known.flight !== flight) return known;
    const before = known.ticks.filter((other) => other.step < tick.step);
    return { ...known, step: tick.step, ticks: [...before, tick] };
  });
  document.value = { ...state, flights };
}

/**
 * A plan that a search found is shown at once, where its search is the one watched. The one that it
 * ends with may be known already, without what the end says of it.
 */
function hearPlan(state: DocumentState, event: Extract<Event, { event: "plan" }>): void {
  const others = state.plans.filter((other) => other.plan !== event.summary.plan);
  document.value = { ...state, plans: [...others, event.summary] };
  if (event.search !== null) void showPlan(event.summary.plan, true);
}

/** The token of the address, which does not stay there: a reload finds it in the session. */
function takeToken(): string {
  const fragment = new URLSearchParams(location.hash.slice(1));
  const query = new URLSearchParams(location.search);
  const told = fragment.get("token") ?? query.get("token");
  if (told === null) return sessionStorage.getItem("token") ?? "";
  sessionStorage.setItem("token", told);
  history.replaceState(null, "", location.pathname);
  return told;
}

/** Connect, and stay connected. */
export function start(): void {
  listen(hear);
  onOpen(() => void attempt(greet()));
  connect(takeToken());
}
