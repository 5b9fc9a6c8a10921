/** Layout: toolbar above, map, side column with tabs, timeline below. */

import { line } from "./connection";
import { FlightRegion, PlanRegion, RiskRegion, TimelineRegion } from "./panels/wiring";
import { tab, type Tab } from "./state/session";

const TABS: readonly (readonly [Tab, string])[] = [
  ["plan", "Plan"],
  ["risk", "Risk"],
  ["flight", "Flight"],
  ["scene", "Scene"],
];

export function Shell() {
  return (
    <div class="shell">
      <header class="toolbar">radmpc</header>
      {line.value === "lost" && <p class="lost" role="status">Connection lost, trying again</p>}
      <main class="map" aria-label="Map" />
      <aside class="side" aria-label="Panels">
        <div role="tablist" aria-label="Panels" class="tabs">
          {TABS.map(([name, label]) => (
            <button
              key={name}
              type="button"
              role="tab"
              id={`tab-${name}`}
              aria-selected={tab.value === name}
              aria-controls="panel"
              tabIndex={tab.value === name ? 0 : -1}
              onClick={() => (tab.value = name)}
            >
              {label}
            </button>
          ))}
        </div>
        <section class="panel" id="panel" role="tabpanel" aria-labelledby={`tab-${tab.value}`}>
          {tab.value === "plan" && <PlanRegion />}
          {tab.value === "risk" && <RiskRegion />}
          {tab.value === "flight" && <FlightRegion />}
        </section>
      </aside>
      <footer class="timeline" aria-label="Time">
        <TimelineRegion />
      </footer>
    </div>
  );
}
