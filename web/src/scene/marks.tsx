/** What is wrong, marked at the thing: buttons on the map that open words and cures. */

import { signal } from "@preact/signals";
import { RemarkLine } from "../edit/remarks";
import { placeOfRemark, thingAt } from "../edit/things";
import { pick } from "../edit/create";
import type { Remark, ScenarioView } from "../protocol";
import { remarks } from "../state/document";
import { switches } from "../state/layers";
import { shown } from "../state/plans";
import { drawn } from "../state/playback";
import { num } from "./geometry";
import { camera } from "./viewport";

/** Places marked at most: more would cover the map. */
const MAX_MARKS = 40;

const opened = signal<string | null>(null);

interface Spot {
  readonly key: string;
  readonly place: readonly number[];
  readonly remarks: readonly Remark[];
}

/** Remarks by place: of the document, and of the plan shown. */
function spotsOf(scenario: ScenarioView, all: readonly Remark[]): readonly Spot[] {
  const spots = new Map<string, { key: string; place: readonly number[]; remarks: Remark[] }>();
  for (const remark of all) {
    const place = placeOfRemark(scenario, remark);
    if (place === null) continue;
    const key = place.join(" ");
    const spot = spots.get(key);
    if (spot !== undefined) spot.remarks.push(remark);
    else if (spots.size < MAX_MARKS) spots.set(key, { key, place, remarks: [remark] });
  }
  return [...spots.values()];
}

export function Marks() {
  const scenario = drawn.value;
  if (scenario === null || !switches.value.remarks) return null;
  const all = [...remarks.value, ...(shown.value?.remarks ?? [])];
  return (
    <div class="marks">
      {spotsOf(scenario, all).map((spot) => (
        <Mark key={spot.key} spot={spot} scenario={scenario} />
      ))}
    </div>
  );
}

function Mark({ spot, scenario }: { spot: Spot; scenario: ScenarioView }) {
  const [px, py] = camera.value.toScreen(num(spot.place, 0), num(spot.place, 1));
  const { width, height } = camera.value;
  const isOpen = opened.value === spot.key;
  if (px < 0 || py < 0 || px > width || py > height) return null;
  const worst = spot.remarks.some((remark) => remark.severity !== "warning") ? "error" : "warning";
  const open = () => {
    opened.value = isOpen ? null : spot.key;
    const [first] = spot.remarks;
    const thing = first === undefined ? null : thingAt(scenario, first.path);
    if (thing !== null && !isOpen) pick(thing);
  };
  return (
    <div class="mark" style={{ transform: `translate(${px}px, ${py}px)` }}>
      <button
        type="button"
        class={worst}
        aria-expanded={isOpen}
        aria-label={spot.remarks.map((remark) => remark.text).join("; ")}
        onClick={open}
        onKeyDown={(event) => {
          if (event.key !== "Escape" || !isOpen) return;
          opened.value = null;
          event.preventDefault();
        }}
      >
        !
      </button>
      {isOpen && (
        <div class={`words ${px > width / 2 ? "left" : ""} ${py > height / 2 ? "above" : ""}`}>
          {spot.remarks.map((remark, i) => (
            <RemarkLine key={i} remark={remark} />
          ))}
        </div>
      )}
    </div>
  );
}
