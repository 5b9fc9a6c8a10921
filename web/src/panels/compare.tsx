/** Two plans side by side, and where they differ most. */

import { useMemo, useState } from "preact/hooks";
import type { PlanView } from "../protocol";
import { Block, Button } from "./controls";
import { differences, type Difference } from "./difference";
import { bound, cost, meters, percentUp, signedCost, signedPercent } from "./format";
import { rove } from "./roving";

/** Vehicles that are listed at first. */
const FIRST = 6;

export interface CompareProps {
  readonly plan: PlanView;
  readonly other: PlanView;
  readonly onEnd: () => void;
  /** Makes the other plan the one shown, and the other way round. */
  readonly onSwap: () => void;
  readonly onPoint: (difference: Difference | null) => void;
  readonly onGo: (difference: Difference) => void;
}

export function Compare(props: CompareProps) {
  const { plan, other } = props;
  const [all, setAll] = useState(false);
  const found = useMemo(() => differences(plan, other), [plan, other]);
  const listed = all ? found : found.slice(0, FIRST);
  return (
    <Block
      title="Compared"
      aside={
        <span class="p-actions">
          <Button kind="quiet" onClick={props.onSwap}>
            Swap
          </Button>
          <Button kind="quiet" onClick={props.onEnd}>
            End
          </Button>
        </span>
      }
    >
      <Numbers plan={plan} other={other} />
      {found.length > 0 && (
        <p class="p-columns p-difference" aria-hidden="true">
          <span>vehicle</span>
          <span>apart, at most</span>
          <span>at</span>
        </p>
      )}
      <ul class="p-differences" onKeyDown={rove} onMouseLeave={() => props.onPoint(null)}>
        {listed.map((one, i) => (
          <li key={one.name}>
            <button type="button" class="p-entry p-difference" data-entry tabIndex={i === 0 ? 0 : -1} onMouseEnter={() => props.onPoint(one)} onFocus={() => props.onPoint(one)} onBlur={() => props.onPoint(null)} onClick={() => props.onGo(one)}>
              <span class="p-name">{one.name}</span>
              <span class="p-heard">, apart at most </span>
              <span class="p-risk">{meters(one.distance)}</span>
              <span class="p-heard">, at </span>
              <span class="p-share">{`${one.time.toFixed(1)} s`}</span>
            </button>
          </li>
        ))}
      </ul>
      {found.length > listed.length && (
        <Button kind="quiet" onClick={() => setAll(true)}>{`${found.length - listed.length} more vehicles`}</Button>
      )}
      {found.length > 0 && <p class="p-note">Distances are at the same time. On the map the other plan is dashed.</p>}
    </Block>
  );
}

function Numbers({ plan, other }: { plan: PlanView; other: PlanView }) {
  const one = plan.summary;
  const two = other.summary;
  const rows: readonly (readonly [string, string, string, string])[] = [
    ["Cost", cost(one.cost), cost(two.cost), one.cost === null || two.cost === null ? "" : signedCost(two.cost - one.cost)],
    ["Risk ≤", percentUp(one.certified), percentUp(two.certified), one.certified === null || two.certified === null ? "" : signedPercent(two.certified - one.certified)],
    ["Δ", bound(one.riskBound), bound(two.riskBound), one.riskBound === two.riskBound ? "same" : signedPercent(two.riskBound - one.riskBound)],
    ["Sets", String(plan.sets.length), String(other.sets.length), ""],
  ];
  return (
    <table class="p-numbers">
      <thead>
        <tr>
          <td />
          <th scope="col">shown</th>
          <th scope="col">other</th>
          <th scope="col">change</th>
        </tr>
      </thead>
      <tbody>
        {rows.map(([name, ...values]) => (
          <tr key={name}>
            <th scope="row">{name}</th>
            {values.map((value, i) => (
              <td key={i}>{value}</td>
            ))}
          </tr>
        ))}
      </tbody>
    </table>
  );
}
