/** A value in a notebook: map or view in space, timeline, ledger. */

import { useEffect, useMemo, useState } from "preact/hooks";
import { percent, percentUp, bound as deltaText } from "../panels/format";
import { risksBySteps, vehiclesOf } from "../panels/ledger";
import { Risk } from "../panels/risk";
import { Timeline } from "../panels/timeline";
import type { LedgerLine, PlanView, ScenarioView } from "../protocol";
import { DARK, LIGHT, vehicleColors } from "../scene/colors";
import { SpaceRegion } from "../space/region";
import type { Highlight } from "../state/selection";
import { NotebookMap, type Still } from "./map";

export interface NotebookViewProps {
  readonly scenario: ScenarioView;
  readonly plan: PlanView | null;
  readonly time: number;
  readonly isDark: boolean;
  readonly onTime: (time: number) => void;
  readonly loadSpace: () => Promise<typeof import("../space/space")>;
}

const SWITCHES: Still["switches"] = {
  tracks: true,
  discs: true,
  hulls: true,
  names: true,
  ghosts: true,
  risk: true,
  trails: false,
  flight: false,
  remarks: false,
};

export function NotebookView(props: NotebookViewProps) {
  const { scenario, plan, time, onTime, isDark } = props;
  const [isPlaying, setPlaying] = useState(false);
  const [speed, setSpeed] = useState(1);
  const [vehicle, setVehicle] = useState<string | null>(null);
  const [highlight, setHighlight] = useState<Highlight | null>(null);
  usePlayback(isPlaying, (seconds) => {
    const next = time + (seconds * speed) / scenario.dt;
    if (next >= scenario.horizon) setPlaying(false);
    onTime(Math.min(next, scenario.horizon));
  });
  const names = useMemo(() => scenario.vehicles.map(({ name }) => name), [scenario]);
  const colors = isDark ? DARK : LIGHT;
  const own = vehicleColors(names, plan?.sets ?? [], colors);
  const point = (lines: readonly LedgerLine[] | null) => setHighlight(lines === null ? null : pointed(lines));
  const frame: Still = {
    time,
    colors,
    vehicleColors: own,
    scenarioColors: own,
    scenario,
    plan: plan?.tracks.length === 0 ? null : plan,
    isStale: false,
    compared: null,
    trails: null,
    flight: null,
    selected: null,
    hovered: null,
    highlight,
    draft: null,
    activeHandle: 0,
    switches: SWITCHES,
  };
  return (
    <section class="radmpc-view" data-theme={isDark ? "dark" : "light"} aria-label={`radmpc: ${scenario.name}`}>
      <p class="n-head">{headOf(scenario, plan)}</p>
      <div class={plan === null ? "n-body" : "n-body n-planned"}>
        <div class="n-place">
          {scenario.dimension === 3 ? <SpaceRegion frame={frame} load={props.loadSpace} /> : <NotebookMap frame={frame} />}
        </div>
        {plan !== null && (
          <div class="n-side">
            {plan.tracks.length > 0 ? (
              <Risk
                plan={plan}
                vehicle={vehicle}
                onVehicle={setVehicle}
                onPoint={point}
                onGo={(lines) => onTime(lines[0]?.step ?? time)}
              />
            ) : (
              <ul class="n-report">{plan.report.map((sentence) => <li key={sentence}>{sentence}</li>)}</ul>
            )}
          </div>
        )}
      </div>
      <Timeline
        time={time}
        horizon={scenario.horizon}
        dt={scenario.dt}
        isPlaying={isPlaying}
        speed={speed}
        risks={plan === null ? null : risksBySteps(plan.ledger, scenario.horizon, vehicle)}
        replans={[]}
        onTime={onTime}
        onPlay={(play) => {
          if (play && time >= scenario.horizon) onTime(0);
          setPlaying(play);
        }}
        onSpeed={setSpeed}
      />
    </section>
  );
}

function pointed(lines: readonly LedgerLine[]): Highlight {
  const [first] = lines;
  const obstacle = first?.cause === "obstacle" ? first.other : null;
  return {
    vehicles: first === undefined ? [] : vehiclesOf(first),
    obstacles: obstacle === null ? [] : [obstacle],
    at: lines.map((line) => line.at),
  };
}

function headOf(scenario: ScenarioView, plan: PlanView | null): string {
  const size = `${scenario.name}: ${scenario.vehicles.length} vehicles, ${scenario.horizon} steps of ${scenario.dt} s`;
  if (plan === null) return `${size}, Δ ${deltaText(scenario.riskBound)}`;
  const { summary } = plan;
  const cost = summary.cost === null ? "no plan" : `cost ${Number(summary.cost.toPrecision(6))}`;
  const risk = summary.certified === null ? "" : `, risk ≤ ${percentUp(summary.certified)} of Δ ${deltaText(summary.riskBound)}`;
  return `${size}; ${summary.status}, ${cost}${risk}, left ${percent(plan.left)}`;
}

/** Calls back at every frame while playing, with the seconds since the last one. */
function usePlayback(isPlaying: boolean, advance: (seconds: number) => void): void {
  useEffect(() => {
    if (!isPlaying) return;
    let request = 0;
    const begun = performance.now();
    request = requestAnimationFrame((now) => advance(Math.max(now - begun, 0) / 1000));
    return () => cancelAnimationFrame(request);
  });
}
