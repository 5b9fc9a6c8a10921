/** What an operator can ask the server for; what it refuses is told in a notice. */

import { batch, type Signal } from "@preact/signals";
import { call, CallError, connect, listen, onOpen } from "./connection";
import type { Change, DocumentState, Event, FlightState, PlanView, SearchState } from "./protocol";
import { accept, document } from "./state/document";
import { followed } from "./state/following";
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
      wanted.shown += 1;
      wanted.compared += 1;
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

/** Once all changes that were asked for have been answered. */
export async function idle(): Promise<void> {
  await last;
}

function next(label: string, make: (state: DocumentState, asked: DocumentState) => Promise<DocumentState> | null): Promise<boolean> {
  const asked = document.peek();
  const done = last.then(async () => {
    const state = document.peek();
    if (asked === null || state === null) return false;
    if (asked.document !== state.document) {
      complain(new Error(`Another document was opened before this was done: ${label}`));
      return false;
    }
    const answer = make(state, asked);
    if (answer === null) return false;
    try {
      take(await answer);
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
  if (newest !== null) take(newest);
}

/** Take the state of the document that is shown, not of one that was shown when it was asked for. */
function take(state: DocumentState): void {
  if (state.document === document.peek()?.document) accept(state);
}

/** Changes as they are made to a document; null where there is none to make. */
export type Making = (state: DocumentState) => readonly Change[] | null;

/**
 * Change the document: one step of undo, named by `label`.
 *
 * Changes that were asked for before may be answered later: `changes` then go where the things are
 * that they were meant for.
 */
export function change(changes: readonly Change[] | Making, label: string): Promise<boolean> {
  return next(label, (state, asked) => {
    const made = typeof changes === "function" ? changes(state) : carried(changes, asked, state);
    if (made === null) return null;
    return call("change", { document: state.document, revision: state.revision, changes: made, label });
  });
}

/** The same changes in a document that has changed since; null once one of their things is gone. */
function carried(changes: readonly Change[], asked: DocumentState, state: DocumentState): readonly Change[] | null {
  if (asked.content === state.content) return changes;
  const paths = changes.map((one) => followed(asked.content, state.content, one.path));
  if (!paths.includes(null)) return changes.map((one, i) => ({ ...one, path: paths[i] ?? one.path }));
  complain(new Error("What was to be changed has been removed meanwhile"));
  return null;
}

export function undo(): Promise<boolean> {
  return next("Undo", ({ document: id, revision, canUndo }) => (canUndo ? call("undo", { document: id, revision }) : null));
}

export function redo(): Promise<boolean> {
  return next("Redo", ({ document: id, revision, canRedo }) => (canRedo ? call("redo", { document: id, revision }) : null));
}

/** The plans that were asked for last: what comes later than they do is not shown. */
const wanted = { shown: 0, compared: 0 };

/** Show a plan on the map. */
export function showPlan(plan: string | null, isNews = false): Promise<void> {
  return turnToPlan("shown", shownId, plan, isNews);
}

/** Compare the plan shown with another. */
export function comparePlan(plan: string | null): Promise<void> {
  return turnToPlan("compared", comparedId, plan);
}

async function turnToPlan(kind: keyof typeof wanted, id: Signal<string | null>, plan: string | null, isNews = false): Promise<void> {
  wanted[kind] += 1;
  const turn = wanted[kind];
  if (plan !== null) await loadPlan(plan, isNews);
  if (turn === wanted[kind]) id.value = plan;
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

/** Take a search as the server has it. */
export function takeSearch(search: SearchState): void {
  const state = document.peek();
  if (state?.document === search.document) document.value = withSearch(state, search);
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
      takeSearch(event.state);
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
