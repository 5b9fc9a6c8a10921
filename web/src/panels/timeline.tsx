/** Time: scrubber, play, and where in time the risk is. */

import { memo } from "./memo";
import { useMemo } from "preact/hooks";
import { percent } from "./format";
import { CAUSES, type Cause } from "./ledger";
import { useWidth } from "./width";

export const SPEEDS = [0.25, 0.5, 1, 2, 5, 10] as const;

const HEIGHT = 28;
/** As in the slider: half the width of its thumb [px]. */
const INSET = 8;

export interface TimelineProps {
  /** [steps], with fractions. */
  readonly time: number;
  readonly horizon: number;
  /** Seconds per step. */
  readonly dt: number;
  readonly isPlaying: boolean;
  /** Mission seconds per second. */
  readonly speed: number;
  /** Risk at each step by cause; null without a plan. */
  readonly risks: Readonly<Record<Cause, readonly number[]>> | null;
  /** Steps at which a flight planned anew. */
  readonly replans: readonly number[];
  readonly onTime: (steps: number) => void;
  readonly onPlay: (isPlaying: boolean) => void;
  readonly onSpeed: (speed: number) => void;
}

export function Timeline(props: TimelineProps) {
  const { time, horizon, dt, isPlaying } = props;
  const [host, width] = useWidth();
  if (horizon === 0) return <p class="p-empty">There is no time before there is a scenario.</p>;
  return (
    <div class="p-timeline" role="group" aria-label="Time" onKeyDown={(event) => void timelineKey(event, props)}>
      <button type="button" class="p-button p-play" aria-label={isPlaying ? "Pause" : "Play"} title={`${isPlaying ? "Pause" : "Play"} (Space)`} onClick={() => props.onPlay(!isPlaying)}>
        <svg width="12" height="12" viewBox="0 0 12 12" aria-hidden="true">
          <path d={isPlaying ? "M2 1H5V11H2ZM7 1H10V11H7Z" : "M2 1 11 6 2 11Z"} />
        </svg>
      </button>
      <select class="p-speed" aria-label="Speed" value={String(props.speed)} onChange={(event) => props.onSpeed(Number(event.currentTarget.value))}>
        {SPEEDS.map((speed) => (
          <option key={speed} value={String(speed)}>{`× ${speed}`}</option>
        ))}
      </select>
      <div class="p-scrubber" ref={host}>
        {width > 0 && <Bars risks={props.risks} horizon={horizon} width={width} replans={props.replans} />}
        <input
          type="range"
          aria-label="Time"
          aria-valuetext={`step ${shortened(time)} of ${horizon}, ${shortened(time * dt)} s`}
          min={0}
          max={horizon}
          step={0.01}
          value={time}
          onInput={(event) => props.onTime(Number(event.currentTarget.value))}
        />
      </div>
      <Readout {...props} />
    </div>
  );
}

function shortened(value: number): string {
  return String(Number(value.toFixed(2)));
}

function Readout({ time, horizon, dt, risks }: TimelineProps) {
  const step = Math.min(Math.round(time), horizon);
  const here = risks === null ? null : CAUSES.reduce((total, cause) => total + (risks[cause][step] ?? 0), 0);
  return (
    <dl class="p-readout">
      <div>
        <dt>step</dt>
        <dd>{`${time.toFixed(1)} / ${horizon}`}</dd>
      </div>
      <div>
        <dt>time</dt>
        <dd>{`${(time * dt).toFixed(1)} / ${(horizon * dt).toFixed(1)} s`}</dd>
      </div>
      <div class="p-here">
        <dt>{`risk at step ${step}`}</dt>
        <dd>{percent(here)}</dd>
      </div>
    </dl>
  );
}

interface BarsProps {
  readonly risks: TimelineProps["risks"];
  readonly horizon: number;
  readonly width: number;
  readonly replans: readonly number[];
}

/** Bars of risk over the steps, causes on top of each other, and marks of replans. */
const Bars = memo(function Bars({ risks, horizon, width, replans }: BarsProps) {
  const place = (step: number) => INSET + (step / horizon) * (width - 2 * INSET);
  const paths = useMemo(() => (risks === null ? [] : barsOf(risks, horizon, width)), [risks, horizon, width]);
  return (
    <svg class="p-bars" width={width} height={HEIGHT} role="img" aria-label={label(risks, horizon, replans)}>
      {paths.map(([cause, path]) => (
        <path key={cause} class={`p-${cause}`} d={path} />
      ))}
      {replans.map((step) => (
        <path key={step} class="p-replan" d={`M${place(step) - 3} 0h6l-3 5Z`} />
      ))}
    </svg>
  );
});

function barsOf(risks: Readonly<Record<Cause, readonly number[]>>, horizon: number, width: number): readonly (readonly [Cause, string])[] {
  const totals = Array.from({ length: horizon + 1 }, (_, step) => CAUSES.reduce((total, cause) => total + (risks[cause][step] ?? 0), 0));
  const most = Math.max(...totals, 1e-300);
  const step = (width - 2 * INSET) / horizon;
  const bar = Math.max(1, Math.min(9, step * 0.7));
  const floors = totals.map(() => HEIGHT);
  return CAUSES.map((cause) => {
    const parts = risks[cause].map((risk, k) => {
      const high = (risk / most) * (HEIGHT - 6);
      if (high < 0.25) return "";
      const floor = floors[k] ?? HEIGHT;
      floors[k] = floor - high;
      return `M${(INSET + k * step - bar / 2).toFixed(1)} ${floor.toFixed(1)}h${bar.toFixed(1)}v${(-high).toFixed(1)}h${(-bar).toFixed(1)}Z`;
    });
    return [cause, parts.join("")] as const;
  });
}

function label(risks: TimelineProps["risks"], horizon: number, replans: readonly number[]): string {
  const planned = replans.length === 0 ? "" : `; planned anew at ${replans.length === 1 ? "step" : "steps"} ${replans.join(", ")}`;
  if (risks === null) return `Time of ${horizon} steps${planned}`;
  const totals = Array.from({ length: horizon + 1 }, (_, step) => CAUSES.reduce((total, cause) => total + (risks[cause][step] ?? 0), 0));
  const worst = totals.indexOf(Math.max(...totals));
  return `Risk over the steps, most at step ${worst}: ${percent(totals[worst] ?? 0)}${planned}`;
}

/** What a key does to time; whether it was one of time's keys. */
export function timelineKey(event: KeyboardEvent, props: Pick<TimelineProps, "time" | "horizon" | "isPlaying" | "onTime" | "onPlay">): boolean {
  if (event.ctrlKey || event.metaKey || event.altKey) return false;
  if (event.target instanceof HTMLSelectElement) return false;
  if (event.key === " ") {
    event.preventDefault();
    props.onPlay(!props.isPlaying);
    return true;
  }
  const to = timeAfter(event.key, event.shiftKey, props.time, props.horizon);
  if (to === null) return false;
  event.preventDefault();
  props.onTime(to);
  return true;
}

/** Arrows go to the next step, with Shift by a tenth. */
export function timeAfter(key: string, isFine: boolean, time: number, horizon: number): number | null {
  const clamp = (value: number) => Math.min(Math.max(value, 0), horizon);
  switch (key) {
    case "ArrowRight":
    case "ArrowUp":
      return clamp(isFine ? time + 0.1 : Math.floor(time + 1e-6) + 1);
    case "ArrowLeft":
    case "ArrowDown":
      return clamp(isFine ? time - 0.1 : Math.ceil(time - 1e-6) - 1);
    case "PageUp":
      return clamp(time + 10);
    case "PageDown":
      return clamp(time - 10);
    case "Home":
      return 0;
    case "End":
      return horizon;
    default:
      return null;
  }
}
