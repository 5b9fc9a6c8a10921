/** The ledger: where Δ goes, by cause and hazard, with its places on the map. */

import { useMemo, useState } from "preact/hooks";
import type { LedgerLine, PlanView } from "../protocol";
import { Block, Button, Empty, Facts } from "./controls";
import { bound as deltaText, percent, percentUp, share } from "./format";
import { between, CAUSE_WORDS, grouped, sum, type Cause, type CauseGroup, type Hazard } from "./ledger";
import { rove } from "./roving";

/** Hazards of a cause that are listed at first, and the share of Δ from which on they are. */
const FIRST = 12;
const WORTH = 1e-3;

export interface RiskProps {
  readonly plan: PlanView | null;
  /** Vehicle whose lines are shown; null is all of them. */
  readonly vehicle: string | null;
  readonly onVehicle: (vehicle: string | null) => void;
  /** Pointed at, or left: null. */
  readonly onPoint: (lines: readonly LedgerLine[] | null) => void;
  /** Chosen: time stays at the riskiest line. */
  readonly onGo: (lines: readonly LedgerLine[]) => void;
}

export function Risk(props: RiskProps) {
  const { plan } = props;
  if (plan === null) {
    return (
      <Block title="Risk">
        <Empty>No plan is shown. Of a plan, this lists where its risk is.</Empty>
      </Block>
    );
  }
  return <Ledger {...props} plan={plan} />;
}

function Ledger(props: RiskProps & { plan: PlanView }) {
  const { plan, vehicle } = props;
  const groups = useMemo(() => grouped(plan.ledger, vehicle), [plan, vehicle]);
  const bound = plan.summary.riskBound;
  const shown = sum(groups.map((group) => group.risk));
  return (
    <Block title="Risk" aside={<span class={plan.summary.holds ? "p-holds" : "p-fails"}>{plan.summary.holds ? "holds" : "over Δ"}</span>}>
      <Facts
        rows={[
          ["Risk ≤", percentUp(plan.summary.certified)],
          ["Δ", deltaText(bound)],
          ["Left of Δ", percent(plan.left)],
          ["Saturation ≤", percentUp(plan.saturation)],
        ]}
      />
      <Stack groups={groups} bound={bound} />
      <div class="p-field p-wide">
        <label for="ledger-vehicle">Vehicle</label>
        <select id="ledger-vehicle" value={vehicle ?? ""} onChange={(event) => props.onVehicle(event.currentTarget.value === "" ? null : event.currentTarget.value)}>
          <option value="">all</option>
          {plan.scenario.vehicles.map((one) => (
            <option key={one.name} value={one.name}>
              {one.name}
            </option>
          ))}
        </select>
        {vehicle !== null && <span class="p-note">{`${percentUp(shown)} of risk in which ${vehicle} takes part`}</span>}
      </div>
      {groups.length === 0 && <Empty>{vehicle === null ? "Nothing is at risk." : `${vehicle} risks nothing.`}</Empty>}
      {groups.length > 0 && (
        <p class="p-columns p-hazard" aria-hidden="true">
          <span>most at step</span>
          <span />
          <span>risk ≤</span>
          <span>of Δ</span>
        </p>
      )}
      <div onKeyDown={rove} onMouseLeave={() => props.onPoint(null)}>
        {groups.map((group, i) => (
          <Group key={group.cause} group={group} bound={bound} isFirst={i === 0} dt={plan.scenario.dt} {...props} />
        ))}
      </div>
    </Block>
  );
}

/** All of Δ as one bar: what each cause takes, and what is left. */
function Stack(props: { groups: readonly CauseGroup[]; bound: number }) {
  const { groups, bound } = props;
  const total = sum(groups.map((group) => group.risk));
  const whole = Math.max(bound, total);
  const label = groups.map((group) => `${CAUSE_WORDS[group.cause]} ${share(group.risk / bound)}`).join(", ");
  return (
    <div class="p-stack" role="img" aria-label={`Shares of Δ: ${label}, left ${share(Math.max(0, 1 - total / bound))}`}>
      {groups.map((group) => (
        <span key={group.cause} class={`p-fill p-${group.cause}`} style={{ width: `${(group.risk / whole) * 100}%` }} />
      ))}
      {total > bound && <span class="p-mark" style={{ left: `${(bound / whole) * 100}%` }} />}
    </div>
  );
}

interface GroupProps extends RiskProps {
  readonly group: CauseGroup;
  readonly bound: number;
  readonly dt: number;
  readonly isFirst: boolean;
}

function Group(props: GroupProps) {
  const { group, bound } = props;
  const [all, setAll] = useState(false);
  const worth = Math.max(1, group.hazards.filter((hazard) => hazard.risk >= WORTH * bound).length);
  const hazards = all ? group.hazards : group.hazards.slice(0, Math.min(worth, FIRST));
  const rest = group.hazards.slice(hazards.length);
  return (
    <div class="p-group" role="group" aria-label={`${CAUSE_WORDS[group.cause]}, ${share(group.risk / bound)} of Δ`}>
      <h3>
        <Sign cause={group.cause} />
        {CAUSE_WORDS[group.cause]}
        <span class="p-risk">{percentUp(group.risk)}</span>
        <span class="p-share">{share(group.risk / bound)}</span>
      </h3>
      <ul>
        {hazards.map((hazard, i) => (
          <HazardRow key={hazard.key} hazard={hazard} {...props} isFirst={props.isFirst && i === 0} />
        ))}
      </ul>
      {rest.length > 0 && (
        <Button kind="quiet" onClick={() => setAll(true)}>
          {`${rest.length} more, together ${percentUp(sum(rest.map((hazard) => hazard.risk)))}`}
        </Button>
      )}
    </div>
  );
}

function HazardRow(props: GroupProps & { hazard: Hazard }) {
  const { hazard, bound, dt } = props;
  const [isOpen, setOpen] = useState(false);
  const [peak] = hazard.lines;
  const toggle = () => {
    setOpen(!isOpen);
    props.onGo(hazard.lines);
  };
  return (
    <li>
      <button
        type="button"
        class="p-entry p-hazard"
        data-entry
        tabIndex={props.isFirst ? 0 : -1}
        aria-expanded={isOpen}
        onMouseEnter={() => props.onPoint(hazard.lines)}
        onFocus={() => props.onPoint(hazard.lines)}
        onBlur={() => props.onPoint(null)}
        onClick={toggle}
      >
        <Cells name={between(hazard)} risk={hazard.risk} bound={bound} step={peak.step} />
        <Bar cause={hazard.cause} part={hazard.risk / bound} />
      </button>
      {isOpen && (
        <ul class="p-lines" aria-label={`${between(hazard)} by steps`}>
          {[...hazard.lines].sort((a, b) => a.step - b.step).map((line) => (
            <li key={line.step}>
              <button type="button" class="p-entry p-hazard" data-entry tabIndex={-1} onMouseEnter={() => props.onPoint([line])} onFocus={() => props.onPoint([line])} onBlur={() => props.onPoint(null)} onClick={() => props.onGo([line])}>
                <Cells name={timed(line.step, dt)} risk={line.risk} bound={bound} />
                <Bar cause={line.cause} part={line.risk / bound} />
              </button>
            </li>
          ))}
        </ul>
      )}
    </li>
  );
}

function timed(step: number, dt: number): string {
  return `step ${step}, ${Number((step * dt).toPrecision(6))} s`;
}

/** What a row shows, with the words between that a listener needs. */
function Cells(props: { name: string; risk: number; bound: number; step?: number }) {
  const { name, risk, bound, step } = props;
  return (
    <>
      <span class="p-name">{name}</span>
      <span class="p-heard">, </span>
      <span class="p-risk">{percentUp(risk)}</span>
      <span class="p-heard">, </span>
      <span class="p-share">{share(risk / bound)}</span>
      <span class="p-heard">{step === undefined ? " of Δ" : " of Δ, most at step "}</span>
      {step !== undefined && <span class="p-step">{step}</span>}
    </>
  );
}

function Bar(props: { cause: Cause; part: number }) {
  return (
    <span class="p-bar">
      <span class={`p-fill p-${props.cause}`} style={{ width: `${Math.min(props.part, 1) * 100}%` }} />
    </span>
  );
}

/** The sign that stands for a cause on the map. */
export function Sign(props: { cause: Cause }) {
  return (
    <svg class={`p-sign p-${props.cause}`} width="10" height="10" viewBox="0 0 10 10" aria-hidden="true">
      {props.cause === "pair" && <circle cx="5" cy="5" r="4" />}
      {props.cause === "obstacle" && <rect x="1.5" y="1.5" width="7" height="7" />}
      {props.cause === "workspace" && <path d="M5 0.5 9.5 5 5 9.5 0.5 5Z" />}
      {props.cause === "range" && <path d="M5 0.5 9.8 9 0.2 9Z" />}
    </svg>
  );
}
