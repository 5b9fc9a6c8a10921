/** Who is planned together, and why. */

import { useState } from "preact/hooks";
import type { CouplingView, PlanView } from "../protocol";
import { Block, Button, Empty } from "./controls";
import { counted } from "./format";

/** Sets that are listed at first. */
const FIRST = 8;

export interface TogetherProps {
  readonly plan: PlanView;
  /** Vehicles pointed at, or left: null. */
  readonly onPoint: (vehicles: readonly string[] | null) => void;
}

export function Together({ plan, onPoint }: TogetherProps) {
  const [all, setAll] = useState(false);
  const sets = [...plan.sets].filter((set) => set.length > 1).sort((a, b) => b.length - a.length);
  const alone = plan.sets.length - sets.length;
  const listed = all ? sets : sets.slice(0, FIRST);
  return (
    <Block title="Planned together" aside={<span class="p-count">{counted(plan.sets.length, "set")}</span>}>
      {sets.length === 0 && <Empty>Every vehicle is planned alone.</Empty>}
      <ul class="p-sets" onMouseLeave={() => onPoint(null)}>
        {listed.map((set) => (
          <li key={set.join("\n")} onMouseEnter={() => onPoint(set)}>
            <details onToggle={(event) => onPoint(event.currentTarget.open ? set : null)}>
              <summary onFocus={() => onPoint(set)} onBlur={() => onPoint(null)}>
                {set.join(", ")}
              </summary>
              <Reasons
                couplings={plan.couplings.filter((one) => set.includes(one.vehicle) && set.includes(one.other))}
                isWhole={plan.sets.length === 1}
              />
            </details>
          </li>
        ))}
      </ul>
      {sets.length > listed.length && (
        <Button kind="quiet" onClick={() => setAll(true)}>{`${sets.length - listed.length} more sets`}</Button>
      )}
      {sets.length > 0 && alone > 0 && <p class="p-note">{`${counted(alone, "vehicle")} planned alone.`}</p>}
    </Block>
  );
}

function Reasons(props: { couplings: readonly CouplingView[]; isWhole: boolean }) {
  if (props.couplings.length === 0) {
    const text = props.isWhole
      ? "The whole fleet is planned at once."
      : "Planned together from the start: no risk of planning them apart was estimated.";
    return <p class="p-note">{text}</p>;
  }
  return (
    <ul class="p-reasons">
      {props.couplings.map((one) => (
        <li key={`${one.vehicle}\n${one.other}`}>
          <strong>{`${one.vehicle} – ${one.other}`}</strong>
          {one.text}
        </li>
      ))}
    </ul>
  );
}
