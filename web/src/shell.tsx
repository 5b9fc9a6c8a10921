/** Layout: toolbar above, map, side column with tabs, timeline below. */

import { useSignal } from "@preact/signals";
import { line } from "./connection";
import { ScenePanel } from "./edit/scene-panel";
import { announcement } from "./edit/tools";
import { Dialogs } from "./files/dialogs";
import { JudgingLine } from "./files/judging";
import { NoticeLine } from "./files/notice";
import { dialog, take } from "./files/saving";
import { FlightRegion, PlanRegion, RiskRegion, TimelineRegion } from "./panels/wiring";
import { Scene } from "./scene/scene";
import { document as opened } from "./state/document";
import { hello, OPENING, sheet, tab, type Tab } from "./state/session";
import { Toolbar } from "./toolbar";

const TABS: readonly (readonly [Tab, string])[] = [
  ["plan", "Plan"],
  ["risk", "Risk"],
  ["flight", "Flight"],
  ["scene", "Scene"],
];

export function Shell() {
  const isDropping = useSignal(false);
  return (
    <div
      class={`shell ${sheet.value} ${isDropping.value ? "dropping" : ""}`}
      onDragOver={(event) => {
        event.preventDefault();
        isDropping.value = true;
      }}
      onDragLeave={(event) => {
        if (event.relatedTarget === null) isDropping.value = false;
      }}
      onDrop={(event) => {
        event.preventDefault();
        isDropping.value = false;
        void take([...(event.dataTransfer?.files ?? [])]);
      }}
    >
      <Toolbar />
      <main class="map">
        <Scene />
        <Welcome />
        <LineState />
      </main>
      <Side />
      <footer class="timeline" aria-label="Time">
        <TimelineRegion />
      </footer>
      <NoticeLine />
      <JudgingLine />
      <p class="unseen" role="status">
        {announcement.value}
      </p>
      <Dialogs />
    </div>
  );
}

function LineState() {
  const state = line.value;
  if (state === "open" || (state === "connecting" && hello.value === null)) return null;
  return (
    <p class="line" role="status">
      {state === "refused"
        ? "The server does not know this page: open the address that it printed at its start."
        : "Connection lost, trying again"}
    </p>
  );
}

function Side() {
  const keys = (event: KeyboardEvent) => {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (by === 0) return;
    const at = TABS.findIndex(([name]) => name === tab.value);
    const next = TABS[(at + by + TABS.length) % TABS.length]?.[0];
    if (next === undefined) return;
    tab.value = next;
    document.getElementById(`tab-${next}`)?.focus();
  };
  return (
    <aside class="side" aria-label="Panels">
      <div role="tablist" aria-label="Panels" class="tabs" onKeyDown={keys}>
        {TABS.map(([name, label]) => (
          <button
            key={name}
            type="button"
            role="tab"
            id={`tab-${name}`}
            aria-selected={tab.value === name}
            aria-controls="panel"
            tabIndex={tab.value === name ? 0 : -1}
            onClick={() => {
              tab.value = name;
              if (sheet.value === "low") sheet.value = "half";
            }}
          >
            {label}
          </button>
        ))}
      </div>
      <SheetButton />
      <div class="panel" id="panel" role="tabpanel" aria-labelledby={`tab-${tab.value}`} tabIndex={0}>
        {tab.value === "plan" && <PlanRegion />}
        {tab.value === "risk" && <RiskRegion />}
        {tab.value === "flight" && <FlightRegion />}
        {tab.value === "scene" && <ScenePanel />}
      </div>
    </aside>
  );
}

/** Raises and lowers the panels where they are a sheet below the map. */
function SheetButton() {
  const next = { low: "half", half: "tall", tall: "low" } as const;
  return (
    <button
      type="button"
      class="sheet plain"
      aria-label={sheet.value === "tall" ? "Lower the panels" : "Raise the panels"}
      onClick={() => (sheet.value = next[sheet.value])}
    >
      {sheet.value === "tall" ? "▾" : "▴"}
    </button>
  );
}

/** With nothing open, the way in; before that is known, what is waited for. */
function Welcome() {
  if (opened.value !== null) return null;
  if (hello.value === null) {
    // The file that the command names is read, and a plan in it judged, before the server answers.
    if (line.value === "refused") return null;
    return (
      <div class="welcome">
        <p role="status">{OPENING}</p>
      </div>
    );
  }
  return (
    <div class="welcome">
      <p>Nothing is open.</p>
      <button type="button" class="primary" onClick={() => (dialog.value = "open")}>
        Open or new
      </button>
      <p class="muted">Or drop a scenario, a plan, a flight or a chart here.</p>
    </div>
  );
}
