/** Simulated missions of a plan: how many collide, against what the certificate says. */

import { useState } from "preact/hooks";
import type { PlanSummary, TrailsView } from "../protocol";
import { Block, Button, Facts, NumberField, Toggle } from "./controls";
import { count, percent, percentUp } from "./format";

export interface SimulateProps {
  readonly plan: PlanSummary;
  readonly trails: TrailsView | null;
  readonly isRunning: boolean;
  readonly isShown: boolean;
  readonly onSimulate: (flights: number, seed: number) => void;
  readonly onToggle: (on: boolean) => void;
}

export function Simulate(props: SimulateProps) {
  const { trails, isRunning } = props;
  const [flights, setFlights] = useState(10000);
  const [seed, setSeed] = useState(0);
  return (
    <Block title="Simulated missions">
      <div class="p-pair">
        <NumberField label="Missions" value={flights} min={1} max={1000000} whole onChange={(value) => setFlights(value ?? 10000)} />
        <NumberField label="Seed" value={seed} min={0} max={2 ** 31} whole onChange={(value) => setSeed(value ?? 0)} />
      </div>
      <div class="p-actions">
        <Button onClick={() => props.onSimulate(flights, seed)} disabled={isRunning || props.plan.cost === null}>
          {isRunning ? "Simulating…" : "Simulate"}
        </Button>
        {trails !== null && <Toggle label="Trails on the map" on={props.isShown} onChange={props.onToggle} />}
      </div>
      {trails !== null && <Outcome trails={trails} plan={props.plan} />}
    </Block>
  );
}

function Outcome({ trails, plan }: { trails: TrailsView; plan: PlanSummary }) {
  const [low, high] = trails.interval;
  return (
    <>
      <Facts
        rows={[
          ["Collide", `${count(trails.collisions)} of ${count(trails.flights)}`],
          ["Rate", percent(trails.collisions / trails.flights)],
          ["95 % interval", `${percent(low)} to ${percent(high)}`, "wide"],
          ["Certified ≤", percentUp(plan.certified)],
        ]}
      />
      <p class="p-note">{judged(trails, plan)}</p>
    </>
  );
}

/** What the interval says of the certificate. */
export function judged(trails: TrailsView, plan: PlanSummary): string {
  if (plan.certified === null) return "There is no certificate to compare with.";
  const [low, high] = trails.interval;
  const bound = percentUp(plan.certified);
  if (low > plan.certified) return `Even the lower end of the interval is above the certified ${bound}: the certificate is contradicted.`;
  if (high <= plan.certified) return `The whole interval is within the certified ${bound}.`;
  return `The interval reaches beyond the certified ${bound}, and does not contradict it; more missions narrow it.`;
}
