/** Time on the page. */

import { computed, effect, signal } from "@preact/signals";
import { scenario } from "./document";
import { shown } from "./plans";

/** Time [steps], with fractions. */
export const time = signal(0);

export const isPlaying = signal(false);

/** Mission seconds per second of the wall. */
export const speed = signal(1);

/** Scenario on the map: the document's, else that of the plan shown. */
export const drawn = computed(() => scenario.value ?? shown.value?.scenario ?? null);

/** Scenario whose time runs: that of the plan shown, else the document's. */
const timed = computed(() => shown.value?.scenario ?? scenario.value);

/** Steps until the end. */
export const horizon = computed(() => timed.value?.horizon ?? 0);

/** Seconds per step. */
export const dt = computed(() => timed.value?.dt ?? 1);

/** Go to a time [steps], within the mission. */
export function seek(steps: number): void {
  time.value = Math.min(Math.max(steps, 0), horizon.peek());
}

/** Whether time goes with a live flight. */
export const isFollowing = signal(true);

/** Go to a time [steps] that the operator has chosen, and stay there whatever flies. */
export function goTo(steps: number): void {
  isFollowing.value = false;
  seek(steps);
}

/** Play, from the start again where the end is reached; or pause. */
export function play(isOn: boolean): void {
  if (isOn) goTo(time.peek() >= horizon.peek() ? 0 : time.peek());
  isPlaying.value = isOn;
}

export function togglePlaying(): void {
  play(!isPlaying.peek());
}

/** Let time run while it plays; called once. */
export function startClock(): void {
  effect(() => {
    if (!isPlaying.value) return;
    let before = performance.now();
    let request = 0;
    const tick = (now: number) => {
      const seconds = Math.min(now - before, 200) / 1000;
      before = now;
      seek(time.peek() + (seconds * speed.peek()) / dt.peek());
      if (time.peek() >= horizon.peek()) isPlaying.value = false;
      else request = requestAnimationFrame(tick);
    };
    request = requestAnimationFrame(tick);
    return () => cancelAnimationFrame(request);
  });
}
