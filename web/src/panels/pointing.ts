/** Pointing from a panel at the map: what is highlighted, and the time that goes with it. */

import { batch } from "@preact/signals";
import type { LedgerLine, Remark } from "../protocol";
import { goTo, isPlaying, seek, time } from "../state/playback";
import { highlight, type Highlight } from "../state/selection";
import type { Difference } from "./difference";
import { vehiclesOf } from "./ledger";

/** Time before a panel was pointed at, to which it goes back [steps]. */
let before: number | null = null;

/** Highlight something and show its time, until `release`. */
function point(at: Highlight, step: number | null): void {
  batch(() => {
    highlight.value = at;
    // What plays goes on: time that jumps while it runs says nothing.
    if (step === null || isPlaying.peek()) return;
    before ??= time.peek();
    seek(step);
  });
}

/** Highlight nothing, and go back to the time before. */
export function release(): void {
  batch(() => {
    highlight.value = null;
    if (before !== null && !isPlaying.peek()) seek(before);
    before = null;
  });
}

/** Stay at the time that is shown. */
export function stay(step: number | null): void {
  before = null;
  if (step !== null) goTo(step);
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
