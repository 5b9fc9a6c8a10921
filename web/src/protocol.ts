/**
 * What the server and the page say to each other: JSON over one WebSocket.
 *
 * The page calls, the server answers each call once and tells of events unasked. The Python side is
 * `src/radmpc/serving/protocol.py`; `tests/serving` holds the two against each other.
 *
 * The page itself is public; the socket is at `SOCKET`, with the token of the page's address
 * (`http://127.0.0.1:PORT/#token=…`, or `?token=…`) as its query `token`. A server that turns a token
 * down closes with `REFUSED`, and the page does not try again.
 */

import type { Change, Document, Ellipse, Json, Path, Remark, ScenarioView } from "./scenes";

export type * from "./scenes";

export const SOCKET = "/socket";
export const REFUSED = 4401;

/** A document that is open on the server. */
export interface DocumentState {
  readonly document: string;
  /** Grows with every change, undo and redo included. */
  readonly revision: number;
  readonly content: Document;
  /** As last understood; of an earlier revision while something is wrong. */
  readonly view: ScenarioView | null;
  readonly remarks: readonly Remark[];
  readonly canUndo: boolean;
  readonly canRedo: boolean;
  /** Path in the folder; null was never saved. */
  readonly file: string | null;
  readonly isSaved: boolean;
  readonly plans: readonly PlanSummary[];
  readonly searches: readonly SearchState[];
  readonly flights: readonly FlightState[];
}

/** A search for plans, in a process of its own. */
export interface SearchState {
  readonly search: string;
  readonly document: string;
  readonly revision: number;
  readonly planner: string;
  readonly state: "running" | "paused" | "ended" | "failed";
  readonly seconds: number;
  readonly limit: number;
  readonly stage: string;
  readonly cost: number | null;
  readonly bound: number | null;
  /** Relative; null without a bound. */
  readonly gap: number | null;
  /** Number of plans found so far. */
  readonly found: number;
  /** How it ended, or why it failed: one line. */
  readonly note: string | null;
}

/** A plan that the server keeps, in few words. */
export interface PlanSummary {
  readonly plan: string;
  readonly revision: number;
  readonly planner: string;
  readonly status: string;
  readonly riskBound: number;
  readonly cost: number | null;
  readonly bound: number | null;
  /** Joint risk by the referee; null without trajectories. */
  readonly certified: number | null;
  readonly holds: boolean;
  readonly seconds: number;
  /** Shadow price of Δ: what 1 more of risk would save [cost]. */
  readonly price: number | null;
  readonly explanation: string | null;
}

/** A line of the ledger: where the risk goes. */
export interface LedgerLine {
  /** `range`: two vehicles that are to stay in reach of each other. */
  readonly cause: "pair" | "obstacle" | "workspace" | "range";
  readonly vehicle: string;
  readonly other: string | null;
  readonly step: number;
  readonly risk: number;
  /** Where on the map [m]. */
  readonly at: readonly number[];
}

/** One vehicle of a plan. */
export interface TrackView {
  readonly name: string;
  /** Means along the way: `perStep` equal parts of each step, and the end. */
  readonly path: readonly (readonly number[])[];
  /** At each step. */
  readonly ellipses: readonly Ellipse[];
  readonly speed: readonly number[];
}

/** Why two vehicles are planned together. */
export interface CouplingView {
  readonly vehicle: string;
  readonly other: string;
  readonly text: string;
}

/** A plan, ready to be drawn. */
export interface PlanView {
  readonly plan: string;
  readonly summary: PlanSummary;
  /** The scenario that it is of, which may since have been changed. */
  readonly scenario: ScenarioView;
  readonly perStep: number;
  readonly tracks: readonly TrackView[];
  readonly ledger: readonly LedgerLine[];
  /** Δ that is not used. */
  readonly left: number;
  /** Bound on what saturated controls add. */
  readonly saturation: number;
  readonly sets: readonly (readonly string[])[];
  readonly couplings: readonly CouplingView[];
  /** Level of the discs: standard deviations, and the probability that they hold. */
  readonly sigmas: number;
  readonly level: number;
  /** Sentences of the report: status, certificate, limits. */
  readonly report: readonly string[];
  /** "Why not" at the place, where there is no plan within the bound. */
  readonly remarks: readonly Remark[];
}

/** Simulated missions of a plan. */
export interface TrailsView {
  readonly plan: string;
  readonly flights: number;
  readonly collisions: number;
  /** 95 % interval of the rate. */
  readonly interval: readonly [number, number];
  /** Some of the flights: colliding ones first. */
  readonly trails: readonly Trail[];
}

/** One simulated mission. */
export interface Trail {
  /** Vehicle by vehicle, places at `perStep` equal parts of each step. */
  readonly paths: readonly (readonly (readonly number[])[])[];
  readonly collision: { readonly at: readonly number[]; readonly time: number; readonly names: readonly string[] } | null;
}

/** A tick of a flight: states measured, what is left of Δ, what was decided. */
export interface TickView {
  readonly step: number;
  readonly states: readonly (readonly number[])[];
  /** Of Δ, not yet used. */
  readonly left: number;
  readonly spent: number;
  /** Who took over: the plan kept, its tail, a new plan. */
  readonly decision: string;
  readonly isReplan: boolean;
  readonly milliseconds: number;
  readonly alarm: string | null;
}

/** A flight under way, or read from its file. */
export interface FlightState {
  readonly flight: string;
  readonly document: string;
  readonly plan: string | null;
  readonly state: "running" | "paused" | "ended" | "failed";
  readonly step: number;
  readonly steps: number;
  readonly riskBound: number;
  readonly ticks: readonly TickView[];
  readonly note: string | null;
}

/** A file of the folder. */
export interface FileEntry {
  readonly path: string;
  readonly kind: "scenario" | "plan" | "flight" | "chart";
  readonly bytes: number;
}

/** How far the referee is with a plan that is read from a file. */
export interface Judging {
  readonly file: string;
  readonly vehicles: number;
  /** Of a processor so far, and after which it is given up [s]. */
  readonly seconds: number;
  readonly limit: number;
  readonly isOver: boolean;
}

/** What the server can do, told once at the start. */
export interface Hello {
  readonly version: string;
  readonly planners: readonly { readonly name: string; readonly text: string }[];
  readonly exports: readonly { readonly name: string; readonly text: string }[];
  readonly templates: readonly { readonly name: string; readonly text: string }[];
  readonly folder: string;
  readonly documents: readonly { readonly document: string; readonly name: string }[];
  /** Whom to show first. */
  readonly document: string | null;
}

/** Calls: what the page sends, and what the server answers. */
export interface Calls {
  hello: [Record<string, never>, Hello];
  files: [Record<string, never>, readonly FileEntry[]];
  /** An empty scenario, or one of the templates. */
  new: [{ template: string | null }, DocumentState];
  /** Scenario, plan, flight or chart by its path in the folder. */
  open: [{ path: string }, DocumentState];
  /** A file that was dropped on the page; at most 4 MiB of text. */
  drop: [{ name: string; content: string; into: string | null }, DocumentState];
  state: [{ document: string }, DocumentState];
  close: [{ document: string }, null];
  /** Refused, with `stale`, unless the revision is the newest. */
  change: [{ document: string; revision: number; changes: readonly Change[]; label: string }, DocumentState];
  undo: [{ document: string; revision: number }, DocumentState];
  redo: [{ document: string; revision: number }, DocumentState];
  save: [{ document: string; path: string; overwrite: boolean }, DocumentState];
  /** `warnings` are what is to be known before the file is used, as `radmpc export` has them. */
  export: [{ plan: string; format: string }, { name: string; base64: string; warnings: readonly string[] }];
  /** Tries cures and looks for what stands in the way: takes seconds. */
  why: [{ document: string }, readonly Remark[]];
  plan: [{ document: string; planner: string; seconds: number; gap: number | null; riskBound: number | null }, SearchState];
  /** Ends a search, which keeps its best plan. */
  stop: [{ search: string }, SearchState];
  pause: [{ search: string }, SearchState];
  resume: [{ search: string }, SearchState];
  view: [{ plan: string }, PlanView];
  savePlan: [{ plan: string; path: string; overwrite: boolean }, null];
  simulate: [{ plan: string; flights: number; seed: number }, TrailsView];
  fly: [{ plan: string; seed: number; pace: number; options: Record<string, Json> }, FlightState];
  stopFlight: [{ flight: string }, FlightState];
  flight: [{ flight: string }, FlightState];
  /** Ends the judging of a file's plan: its scenario is opened without the plan. */
  stopJudging: [{ file: string }, null];
}

export type CallName = keyof Calls;

export type Request = {
  [N in CallName]: { readonly id: number; readonly call: N; readonly args: Calls[N][0] };
}[CallName];

export interface Failure {
  /**
   * `stale`: changed elsewhere; `refused`: bad input, in words; `exists`: a file that `overwrite`
   * would replace; `limit`; `gone`; `internal`.
   */
  readonly kind: "stale" | "refused" | "exists" | "limit" | "gone" | "internal";
  readonly text: string;
  readonly path: Path | null;
}

export type Answer =
  | { readonly id: number; readonly result: unknown }
  | { readonly id: number; readonly failure: Failure };

/** Events: told to every page that shows the document. */
export type Event =
  | { readonly event: "document"; readonly state: DocumentState }
  | { readonly event: "search"; readonly state: SearchState }
  | { readonly event: "plan"; readonly document: string; readonly summary: PlanSummary; readonly search: string | null }
  | { readonly event: "flight"; readonly state: FlightState }
  | { readonly event: "tick"; readonly flight: string; readonly tick: TickView }
  | { readonly event: "judging"; readonly state: Judging };
