/** Flights, live or from a log: the account of Δ, replans, ticks, alarms. */

import { useMemo } from "preact/hooks";
import type { FlightState, PlanSummary, TickView } from "../protocol";
import { accountLines, alarmed, replans, tickAt, tickLines, tickTimes } from "./account";
import { Block, Button, Empty, Facts, NumberField, Toggle } from "./controls";
import { Curve, Key } from "./curve";
import { bound, counted, duration, leftOf, percent } from "./format";
import { Speaker } from "./speaking";

/** Mission seconds per second of the wall; 0 is as fast as it goes. */
const PACES = [1, 2, 5, 10, 0] as const;

/** How a plan is to be flown. */
export interface FlightOrder {
  readonly seed: number;
  /** Mission seconds per second; 0 is as fast as it goes. */
  readonly pace: number;
  /** Whether another plan may be taken on the way. */
  readonly replans: boolean;
  /** Where the flight file is kept; empty keeps none. */
  readonly log: string;
}

export interface FlightProps {
  /** Plan that would be flown. */
  readonly plan: PlanSummary | null;
  readonly flights: readonly FlightState[];
  readonly flight: FlightState | null;
  readonly dt: number;
  /** [steps] */
  readonly time: number;
  /** Whether time goes with the flight. */
  readonly isFollowing: boolean;
  readonly order: FlightOrder;
  readonly onOrder: (order: FlightOrder) => void;
  readonly onFly: () => void;
  readonly onStop: (flight: string) => void;
  readonly onChoose: (flight: string | null) => void;
  readonly onTime: (steps: number) => void;
  readonly onFollow: (isFollowing: boolean) => void;
}

export function Flight(props: FlightProps) {
  const { flight, flights } = props;
  return (
    <>
      <Start {...props} />
      {flights.length > 1 && <Chooser {...props} />}
      {flight === null ? (
        <Block title="Flight">
          <Empty>No flight. A plan can be flown here, or a flight file opened.</Empty>
        </Block>
      ) : (
        <Course {...props} flight={flight} />
      )}
    </>
  );
}

function Start(props: FlightProps) {
  const { plan, flights, order, onOrder } = props;
  const { seed, pace, log } = order;
  const isFlying = flights.some((one) => one.state === "running");
  const canFly = plan?.holds === true && !isFlying;
  return (
    <Block title="Fly the plan shown">
      <div class="p-pair">
        <NumberField label="Seed of the noise" value={seed} min={0} max={2 ** 31} whole onChange={(value) => onOrder({ ...order, seed: value ?? 0 })} />
        <div class="p-field">
          <label for="flight-pace">Pace</label>
          <select id="flight-pace" value={String(pace)} onChange={(event) => onOrder({ ...order, pace: Number(event.currentTarget.value) })}>
            {PACES.map((one) => (
              <option key={one} value={String(one)}>
                {one === 0 ? "fastest" : `× ${one}`}
              </option>
            ))}
          </select>
        </div>
      </div>
      <div class="p-field p-wide">
        <label for="flight-log">Log file</label>
        <input id="flight-log" class="p-path" value={log} placeholder="not kept; such as first.flight.jsonl" spellcheck={false} autocomplete="off" onInput={(event) => onOrder({ ...order, log: event.currentTarget.value })} />
      </div>
      <div class="p-actions">
        <Toggle label="Plan anew on the way" on={order.replans} onChange={(replans) => onOrder({ ...order, replans })} />
      </div>
      <div class="p-actions">
        <Button kind="main" disabled={!canFly} onClick={props.onFly}>
          Fly
        </Button>
        <span class="p-note">{whyNotFly(plan, isFlying)}</span>
      </div>
    </Block>
  );
}

function whyNotFly(plan: PlanSummary | null, isFlying: boolean): string {
  if (isFlying) return "One flight at a time.";
  if (plan === null) return "No plan is shown.";
  return plan.holds ? "" : "The plan shown does not hold Δ.";
}

function Chooser({ flights, flight, onChoose }: FlightProps) {
  return (
    <div class="p-block p-field p-wide">
      <label for="flight-which">Flight</label>
      <select id="flight-which" value={flight?.flight ?? ""} onChange={(event) => onChoose(event.currentTarget.value === "" ? null : event.currentTarget.value)}>
        <option value="">none</option>
        {flights.map((one, i) => (
          <option key={one.flight} value={one.flight}>{`${i + 1}: ${one.state}, step ${one.step} of ${one.steps}`}</option>
        ))}
      </select>
    </div>
  );
}

function Course(props: FlightProps & { flight: FlightState }) {
  const { flight, dt, time } = props;
  const isRunning = flight.state === "running";
  const tick = tickAt(flight, time);
  return (
    <>
      <Block
        title="Flight"
        aside={
          <span class={`p-state p-${flight.state}`}>{`${flight.state}, step ${flight.step} of ${flight.steps}`}</span>
        }
      >
        <Account {...props} />
        <div class="p-actions">
          {isRunning && <Button onClick={() => props.onStop(flight.flight)}>Stop</Button>}
          {isRunning && (
            <label class="p-toggle">
              <input type="checkbox" checked={props.isFollowing} onChange={(event) => props.onFollow(event.currentTarget.checked)} />
              Follow
            </label>
          )}
        </div>
        {flight.note !== null && <p class="p-note">{flight.note}</p>}
        <Speaker text={spoken(flight)} urgent={!isRunning} />
      </Block>
      {tick !== null && <Moment tick={tick} steps={flight.steps} {...props} />}
      <Ticks flight={flight} dt={dt} at={time * dt} />
      <Alarms flight={flight} dt={dt} onTime={props.onTime} />
    </>
  );
}

/** What a listener is told: ends, replans and alarms, not every tick. */
function spoken(flight: FlightState): string {
  const planned = counted(replans(flight).length, "new plan");
  const alarms = counted(alarmed(flight).length, "alarm");
  const ended = flight.state === "running" ? "" : ` ${flight.note ?? ""}`;
  return `Flight ${flight.state}: ${planned}, ${alarms}.${ended}`;
}

function Account({ flight, dt, time }: FlightProps & { flight: FlightState }) {
  const lines = useMemo(() => accountLines(flight, dt), [flight, dt]);
  const last = flight.ticks.at(-1);
  if (last === undefined) return <Empty>No tick yet.</Empty>;
  const planned = counted(replans(flight).length, "new plan");
  const label = `Account of Δ over ${counted(flight.ticks.length, "tick")}: ${leftOf(flight.riskBound, last.left)} left of ${bound(flight.riskBound)}, ${planned}`;
  return (
    <>
      <Facts
        rows={[
          ["Left of Δ", leftOf(flight.riskBound, last.left)],
          ["Used", percent(last.spent)],
          ["Δ", bound(flight.riskBound)],
          ["New plans", String(replans(flight).length)],
        ]}
      />
      <Curve label={label} lines={lines} height={120} xUnit="s" xTo={flight.steps * dt} fromZero format={bound} at={time * dt} />
      <Key lines={lines} />
      {flight.ticks.some((tick) => tick.left > flight.riskBound) && (
        <p class="p-note">Above Δ where what was measured was bad news.</p>
      )}
    </>
  );
}

/** The tick at the time shown, with a scrubber over ticks. */
function Moment(props: FlightProps & { flight: FlightState; tick: TickView; steps: number }) {
  const { tick, flight, dt } = props;
  const index = flight.ticks.indexOf(tick);
  return (
    <Block title={`Tick at step ${tick.step}`} aside={<span class="p-count">{`${Number((tick.step * dt).toPrecision(6))} s`}</span>}>
      <input
        type="range"
        class="p-wide"
        aria-label="Tick"
        aria-valuetext={`step ${tick.step}: ${tick.decision}`}
        min={0}
        max={flight.ticks.length - 1}
        step={1}
        value={index}
        onInput={(event) => props.onTime(flight.ticks[Number(event.currentTarget.value)]?.step ?? 0)}
      />
      <p class="p-decision">
        {tick.isReplan && <strong>planned anew</strong>}
        {tick.decision}
      </p>
      <Facts
        rows={[
          ["Left of Δ", leftOf(flight.riskBound, tick.left)],
          ["Used", percent(tick.spent)],
          ["Took", duration(tick.milliseconds)],
        ]}
      />
      {tick.left > flight.riskBound && (
        <p class="p-note">Above Δ: as measured here, what is still ahead is likelier to collide than the plan was at its start.</p>
      )}
      {tick.alarm !== null && <p class="p-alarm">{tick.alarm}</p>}
    </Block>
  );
}

function Ticks({ flight, dt, at }: { flight: FlightState; dt: number; at: number }) {
  const lines = useMemo(() => tickLines(flight, dt), [flight, dt]);
  const times = tickTimes(flight);
  if (times === null) return null;
  const [median, most] = times;
  const text = `median ${duration(median)}, most ${duration(most)}, step ${duration(dt * 1000)}`;
  return (
    <Block title="Time of ticks">
      <Curve label={`Time of ticks: ${text}`} lines={lines} height={80} xUnit="s" xTo={flight.steps * dt} fromZero format={duration} at={at} />
      <p class="p-note">{text}</p>
    </Block>
  );
}

function Alarms({ flight, dt, onTime }: { flight: FlightState; dt: number; onTime: (steps: number) => void }) {
  const found = alarmed(flight);
  return (
    <Block title="Alarms" aside={<span class="p-count">{found.length}</span>}>
      {found.length === 0 && <Empty>None: what is measured is as the model expects.</Empty>}
      <ul class="p-alarms">
        {found.map((tick) => (
          <li key={tick.step}>
            <button type="button" class="p-entry" onClick={() => onTime(tick.step)}>
              <strong>{`${Number((tick.step * dt).toPrecision(6))} s`}</strong>
              {tick.alarm}
            </button>
          </li>
        ))}
      </ul>
    </Block>
  );
}
