/** Time on the page. */

import { computed, signal } from "@preact/signals";
import { scenario } from "./document";
import { shown } from "./plans";

/** Time [steps], with fractions. */
export const time = signal(0);

export const isPlaying = signal(false);

/** Mission seconds per second of the wall. */
export const speed = signal(1);

/** Scenario that is drawn: that of the plan shown, else the document's. */
export const drawn = computed(() => shown.value?.scenario ?? scenario.value);

/** Steps until the end. */
export const horizon = computed(() => drawn.value?.horizon ?? 0);

/** Seconds per step. */
export const dt = computed(() => drawn.value?.dt ?? 1);

export function seek(steps: number): void {
  time.value = Math.min(Math.max(steps, 0), horizon.value);
}
