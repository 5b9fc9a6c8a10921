/**
 * Side panels and the timeline, wired to the state.
 *
 * The shell puts these into its regions: `PlanRegion`, `RiskRegion` and `FlightRegion` into tabs of
 * the side column, `TimelineRegion` below the map.
 */

export function PlanRegion() {
  return <p class="empty">No plan.</p>;
}

export function RiskRegion() {
  return <p class="empty">No plan.</p>;
}

export function FlightRegion() {
  return <p class="empty">No flight.</p>;
}

export function TimelineRegion() {
  return null;
}
