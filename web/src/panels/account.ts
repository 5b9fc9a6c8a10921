/** What a flight's ticks say, as curves and as the tick of a moment. */

import type { FlightState, TickView } from "../protocol";
import type { Line } from "./curve";

/** Last tick at or before a time [steps]; the first one before it, null where there is none. */
export function tickAt(flight: FlightState, time: number): TickView | null {
  const { ticks } = flight;
  let low = 0;
  let high = ticks.length - 1;
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if ((ticks[middle]?.step ?? Infinity) <= time + 1e-6) low = middle;
    else high = middle - 1;
  }
  return ticks[low] ?? null;
}

/** Steps at which another plan was taken. */
export function replans(flight: FlightState | null): readonly number[] {
  return flight === null ? [] : flight.ticks.filter((tick) => tick.isReplan).map((tick) => tick.step);
}

/** Ticks with alarms. */
export function alarmed(flight: FlightState): readonly (TickView & { readonly alarm: string })[] {
  return flight.ticks.flatMap((tick) => (tick.alarm === null ? [] : [{ ...tick, alarm: tick.alarm }]));
}

/** The account of Δ over time [s]: what is left, where it was planned anew, Δ itself. */
export function accountLines(flight: FlightState, dt: number): readonly Line[] {
  const left = flight.ticks.map((tick): [number, number] => [tick.step * dt, tick.left]);
  const adopted = flight.ticks.filter((tick) => tick.isReplan);
  const lines: Line[] = [
    { name: "left of Δ", points: left, color: "--accent", look: "area" },
    {
      name: "Δ",
      points: [[0, flight.riskBound], [flight.steps * dt, flight.riskBound]],
      color: "--alert",
      look: "line",
      dashed: true,
    },
  ];
  if (adopted.length > 0) {
    lines.push({ name: "planned anew", points: adopted.map((tick) => [tick.step * dt, tick.left]), color: "--text", look: "dots" });
  }
  return lines;
}

/** What ticks took [ms] over time [s], and how long a step is. */
export function tickLines(flight: FlightState, dt: number): readonly Line[] {
  return [
    {
      name: "tick",
      points: flight.ticks.map((tick) => [tick.step * dt, tick.milliseconds]),
      color: "--accent",
      look: "dots",
    },
  ];
}

/** Median and largest of what ticks took [ms]; null without ticks. */
export function tickTimes(flight: FlightState): readonly [median: number, most: number] | null {
  const sorted = flight.ticks.map((tick) => tick.milliseconds).sort((a, b) => a - b);
  const median = sorted[Math.floor((sorted.length - 1) / 2)];
  const most = sorted.at(-1);
  return median === undefined || most === undefined ? null : [median, most];
}
