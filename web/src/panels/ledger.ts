/** The ledger of a plan, put together for people: by cause, by hazard, by step. */

import type { LedgerLine } from "../protocol";

export type Cause = LedgerLine["cause"];

export const CAUSES: readonly Cause[] = ["pair", "obstacle", "workspace", "range"];

/** Headings of the causes. */
export const CAUSE_WORDS: Readonly<Record<Cause, string>> = {
  pair: "Vehicles with each other",
  obstacle: "Obstacles",
  workspace: "Workspace",
  range: "Out of each other's range",
};

/** One thing that may go wrong, over all steps. */
export interface Hazard {
  readonly key: string;
  readonly cause: Cause;
  readonly vehicle: string;
  readonly other: string | null;
  readonly risk: number;
  /** Its lines, the riskiest first; never empty. */
  readonly lines: readonly [LedgerLine, ...LedgerLine[]];
}

/** The hazards of one cause, the riskiest first. */
export interface CauseGroup {
  readonly cause: Cause;
  readonly risk: number;
  readonly hazards: readonly Hazard[];
}

/** Whether a line is about two vehicles. */
function isOfTwo(line: LedgerLine): boolean {
  return line.cause === "pair" || line.cause === "range";
}

/** Whether a line is about a vehicle; null is any. */
export function concerns(line: LedgerLine, vehicle: string | null): boolean {
  return vehicle === null || line.vehicle === vehicle || (isOfTwo(line) && line.other === vehicle);
}

/** The ledger by cause and hazard, of one vehicle or of all; causes without risk are left out. */
export function grouped(ledger: readonly LedgerLine[], vehicle: string | null): readonly CauseGroup[] {
  const found = new Map<string, [LedgerLine, ...LedgerLine[]]>();
  for (const line of ledger) {
    if (!concerns(line, vehicle)) continue;
    const key = hazardKey(line);
    const lines = found.get(key);
    if (lines === undefined) found.set(key, [line]);
    else lines.push(line);
  }
  const hazards = [...found].map(([key, lines]) => hazardOf(key, lines)).sort((a, b) => b.risk - a.risk);
  return CAUSES.map((cause) => {
    const own = hazards.filter((hazard) => hazard.cause === cause);
    return { cause, risk: sum(own.map((hazard) => hazard.risk)), hazards: own };
  }).filter((group) => group.hazards.length > 0);
}

/** What names a hazard. */
export function hazardKey(line: LedgerLine): string {
  return [line.cause, line.vehicle, line.other ?? ""].join("\n");
}

function hazardOf(key: string, lines: [LedgerLine, ...LedgerLine[]]): Hazard {
  lines.sort((a, b) => b.risk - a.risk);
  const [first] = lines;
  const { cause, vehicle, other } = first;
  return { key, cause, vehicle, other, risk: sum(lines.map((line) => line.risk)), lines };
}

/** Whom a line is about: `tug – barge`, `pilot – islet`, `tug – edge`. */
export function between(line: { readonly cause: Cause; readonly vehicle: string; readonly other: string | null }): string {
  const other = line.other ?? (line.cause === "workspace" ? "edge" : "all far away");
  return `${line.vehicle} – ${other}`;
}

/** Vehicles that a line is about. */
export function vehiclesOf(line: LedgerLine): readonly string[] {
  return isOfTwo(line) && line.other !== null ? [line.vehicle, line.other] : [line.vehicle];
}

/** Risk at every step, cause by cause: as many numbers as there are steps, the start included. */
export function risksBySteps(
  ledger: readonly LedgerLine[],
  horizon: number,
  vehicle: string | null,
): Readonly<Record<Cause, readonly number[]>> {
  const risks: Record<Cause, number[]> = {
    pair: zeros(horizon + 1),
    obstacle: zeros(horizon + 1),
    workspace: zeros(horizon + 1),
    range: zeros(horizon + 1),
  };
  for (const line of ledger) {
    if (!concerns(line, vehicle)) continue;
    const step = Math.min(Math.max(line.step, 0), horizon);
    const row = risks[line.cause];
    row[step] = (row[step] ?? 0) + line.risk;
  }
  return risks;
}

/** A sum that does not lose small addends among large ones. */
export function sum(values: readonly number[]): number {
  return [...values].sort((a, b) => a - b).reduce((total, value) => total + value, 0);
}

function zeros(length: number): number[] {
  return Array.from({ length }, () => 0);
}
