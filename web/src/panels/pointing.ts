/** Pointing from a panel at the map: what is highlighted, and the time that goes with it. */

import { batch, signal } from "@preact/signals";
import type { LedgerLine, Remark } from "../protocol";
import { goTo, isPlaying, seek, time } from "../state/playback";
import { highlight, type Highlight } from "../state/selection";
import type { Difference } from "./difference";
import { vehiclesOf } from "./ledger";

/** Time before a panel was pointed at, to which it goes back [steps]; null where time is not pointed at. */
const before = signal<number | null>(null);

/** Whether the time shown is that of what is pointed at, which does not go on with a flight. */
export function isPointing(): boolean {
  return before.value !== null;
}

/** Highlight something and show its time, until `release`. */
function point(at: Highlight, step: number | null): void {
  batch(() => {
    highlight.value = at;
    // What plays goes on: time that jumps while it runs says nothing.
    if (step === null || isPlaying.peek()) return;
    before.value ??= time.peek();
    seek(step);
  });
}

/** Highlight nothing, and go back to the time before. */
export function release(): void {
  batch(() => {
    highlight.value = null;
    const step = before.peek();
    if (step !== null && !isPlaying.peek()) seek(step);
    before.value = null;
  });
}

/** Stay at the time that is shown. */
export function stay(step: number | null): void {
  batch(() => {
    if (step !== null) goTo(step);
    before.value = null;
  });
}

export function pointAtLines(lines: readonly LedgerLine[] | null): void {
  const [peak] = lines ?? [];
  if (lines === null || peak === undefined) {
    release();
    return;
  }
  const obstacles = peak.cause === "obstacle" && peak.other !== null ? [peak.other] : [];
  point({ vehicles: vehiclesOf(peak), obstacles, at: lines.map((line) => line.at) }, peak.step);
}

export function pointAtRemark(remark: Remark | null): void {
  if (remark === null) {
    release();
    return;
  }
  point({ vehicles: remark.vehicles, obstacles: [], at: remark.at === null ? [] : [remark.at] }, null);
}

export function pointAtVehicles(vehicles: readonly string[] | null): void {
  if (vehicles === null) {
    release();
    return;
  }
  point({ vehicles, obstacles: [], at: [] }, null);
}

export function pointAtDifference(difference: Difference | null): void {
  if (difference === null) {
    release();
    return;
  }
  point({ vehicles: [difference.name], obstacles: [], at: [difference.here, difference.there] }, difference.step);
}
