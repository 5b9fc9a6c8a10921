/** The search for plans: what is asked for, how far it is, what it found over time. */

import { useMemo } from "preact/hooks";
import type { Hello, SearchState } from "../protocol";
import { Block, Button, Choice, Facts, NumberField } from "./controls";
import { Curve, Key, type Line } from "./curve";
import { bound, cost, count, counted, gap, ofPercent, seconds, trimmed } from "./format";
import { Speaker } from "./speaking";

/** What the next search is asked for. */
export interface Wishes {
  readonly planner: string;
  readonly seconds: number;
  /** Relative; null is the planner's own. */
  readonly gap: number | null;
}

/** A moment of a search. */
export interface Moment {
  readonly seconds: number;
  readonly cost: number | null;
  readonly bound: number | null;
}

export interface SearchProps {
  readonly planners: Hello["planners"];
  readonly wishes: Wishes;
  /** Why nothing can be planned now; null where it can. */
  readonly refusal: string | null;
  readonly search: SearchState | null;
  readonly moments: readonly Moment[];
  /** Δ of the next search. */
  readonly riskBound: number;
  readonly onWishes: (wishes: Wishes) => void;
  readonly onPlan: () => void;
  readonly onPause: () => void;
  readonly onResume: () => void;
  readonly onStop: () => void;
}

export function Search(props: SearchProps) {
  const { wishes, onWishes, search } = props;
  const isActive = search !== null && (search.state === "running" || search.state === "paused");
  return (
    <Block title="Search">
      <div class="p-grid">
        <Choice label="Planner" value={wishes.planner} options={props.planners} onChange={(planner) => onWishes({ ...wishes, planner })} />
        <div class="p-pair">
          <NumberField label="Time limit" unit="s" value={wishes.seconds} min={0.1} max={86400} onChange={(value) => onWishes({ ...wishes, seconds: value ?? 60 })} />
          <NumberField label="Gap" unit="%" value={wishes.gap === null ? null : Number((wishes.gap * 100).toPrecision(6))} min={1e-7} max={100} optional onChange={(value) => onWishes({ ...wishes, gap: value === null ? null : ofPercent(value) })} />
        </div>
      </div>
      <div class="p-actions">
        <Next {...props} />
        {isActive && <Button onClick={props.onStop}>Stop</Button>}
      </div>
      {!isActive && props.refusal !== null && <p class="p-note">{props.refusal}</p>}
      {search !== null && <Progress search={search} moments={props.moments} />}
      <Speaker text={search === null ? "" : sentence(search)} urgent={!isActive} />
    </Block>
  );
}

/** One button for what comes next, so that it keeps the focus while its words change. */
function Next({ search, refusal, riskBound, onPlan, onPause, onResume }: SearchProps) {
  if (search?.state === "running") return <Button onClick={onPause}>Pause</Button>;
  if (search?.state === "paused") return <Button kind="main" onClick={onResume}>Resume</Button>;
  return <Button kind="main" onClick={onPlan} disabled={refusal !== null}>{`Plan at Δ = ${bound(riskBound)}`}</Button>;
}

/** What a listener is told: it changes with what was found, not with the clock. */
export function sentence(search: SearchState): string {
  const found = search.found === 0 ? "no plan yet" : `${counted(search.found, "plan")} found, cost ${cost(search.cost)}`;
  switch (search.state) {
    case "running":
      return `Planning: ${found}`;
    case "paused":
      return `Paused: ${found}`;
    case "ended":
      return `Ended: ${search.note ?? found}`;
    case "failed":
      return `Failed: ${search.note ?? "no reason was told"}`;
  }
}

const STATES: Readonly<Record<SearchState["state"], string>> = {
  running: "running",
  paused: "paused",
  ended: "ended",
  failed: "failed",
};

function Progress(props: { search: SearchState; moments: readonly Moment[] }) {
  const { search, moments } = props;
  const isActive = search.state === "running" || search.state === "paused";
  return (
    <div class="p-progress">
      {isActive && (
        <progress max={search.limit} value={Math.min(search.seconds, search.limit)} aria-label={`Time of the limit of ${seconds(search.limit)}`} />
      )}
      <p class={`p-stage p-${search.state}`}>
        <strong>{STATES[search.state]}</strong>
        {isActive ? search.stage : (search.note ?? search.stage)}
      </p>
      <Facts
        rows={[
          ["Cost", cost(search.cost)],
          ["Lower bound", cost(search.bound)],
          ["Gap", gap(search.gap)],
          ["Plans found", count(search.found)],
          ["Time", seconds(search.seconds)],
          ["Limit", seconds(search.limit)],
        ]}
      />
      <Course moments={moments} />
    </div>
  );
}

/** Cost and bound over time. */
function Course(props: { moments: readonly Moment[] }) {
  const { moments } = props;
  const lines = useMemo(() => courseLines(moments), [moments]);
  if (lines.length === 0) return null;
  const last = moments.at(-1);
  const label = `Cost and lower bound over ${seconds(last?.seconds ?? 0)}: cost ${cost(last?.cost ?? null)}, bound ${cost(last?.bound ?? null)}`;
  return (
    <>
      <Curve label={label} lines={lines} height={110} xUnit="s" format={(value) => trimmed(value)} />
      <Key lines={lines} />
    </>
  );
}

function courseLines(moments: readonly Moment[]): readonly Line[] {
  const pick = (key: "cost" | "bound") =>
    moments.flatMap((moment): [number, number][] => {
      const value = moment[key];
      return value === null ? [] : [[moment.seconds, value]];
    });
  const lines: Line[] = [
    { name: "cost", points: pick("cost"), color: "--accent", look: "steps" },
    { name: "lower bound", points: pick("bound"), color: "--muted", look: "steps", dashed: true },
  ];
  return lines.filter((line) => line.points.length > 1);
}
