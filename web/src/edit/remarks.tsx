/** Remarks in words, with their cures as buttons. */

import { change } from "../actions";
import type { Remark } from "../protocol";
import { drawn } from "../state/playback";
import { reveal } from "../scene/viewport";
import { pick } from "./create";
import { placeOfRemark, thingAt } from "./things";

const WORDS = { error: "Error", fatal: "No plan", warning: "Note" };

/** One remark; its words lead to the thing where `leads` says so. */
export function RemarkLine({ remark, leads = false }: { remark: Remark; leads?: boolean }) {
  return (
    <div class={`remark ${remark.severity}`}>
      <span class="severity">{WORDS[remark.severity]}</span>
      {leads ? (
        <button type="button" class="words-button" onClick={() => lead(remark)}>
          {remark.text}
        </button>
      ) : (
        <span>{remark.text}</span>
      )}
      {remark.cures.map((cure) => (
        <button key={cure.label} type="button" class="cure" onClick={() => void change(cure.changes, cure.label)}>
          {cure.label}
        </button>
      ))}
    </div>
  );
}

/** Select what the remark is about, and bring it into view. */
function lead(remark: Remark): void {
  const scenario = drawn.peek();
  if (scenario === null) return;
  const thing = thingAt(scenario, remark.path);
  if (thing !== null) pick(thing);
  const place = placeOfRemark(scenario, remark);
  if (place !== null) reveal(place[0] ?? 0, place[1] ?? 0);
}
