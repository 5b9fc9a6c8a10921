/** What is under the pointer, in few words. */

import { useComputed } from "@preact/signals";
import { goalAt, nameOf, obstacleAt, vehicleAt } from "../edit/things";
import type { ScenarioView } from "../protocol";
import { switches } from "../state/layers";
import { shown } from "../state/plans";
import { drawn } from "../state/playback";
import { hovered, type Thing } from "../state/selection";
import { num } from "./geometry";
import { markAt, markText } from "./layers/risk";
import { pointer } from "./pointer";
import { camera } from "./viewport";
import { obstacleWords, short, vehicleWords } from "./words";

export function Tip() {
  const text = useComputed(() => {
    const scenario = drawn.value;
    const thing = hovered.value;
    const risk = riskUnder();
    if (risk !== null) return risk;
    return scenario === null || thing === null || thing.kind === "workspace" ? null : wordsOf(scenario, thing);
  }).value;
  const at = pointer.value;
  if (text === null || at === null) return null;
  return (
    <p class="tip" aria-hidden="true" style={{ transform: `translate(${at.px + 14}px, ${at.py + 14}px)` }}>
      {text}
    </p>
  );
}

/** Cause, step and share of the risk under the pointer. */
function riskUnder(): string | null {
  const at = pointer.value;
  const plan = shown.value;
  if (at === null || plan === null || !switches.value.risk) return null;
  const mark = markAt(plan, camera.value, at.px, at.py);
  return mark === null ? null : markText(mark);
}

function wordsOf(scenario: ScenarioView, thing: Thing): string {
  const name = nameOf(scenario, thing);
  const goal = goalAt(scenario, thing.path);
  if (goal !== null) {
    const { min, max } = goal.box;
    return `${name}, ${short(num(max, 0) - num(min, 0))} × ${short(num(max, 1) - num(min, 1))} m`;
  }
  const vehicle = vehicleAt(scenario, thing.path);
  if (vehicle !== null) return vehicleWords(vehicle);
  const obstacle = obstacleAt(scenario, thing.path);
  return obstacle === null ? name : obstacleWords(obstacle, shown.value);
}
