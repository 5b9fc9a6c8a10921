/** What a layer is given to draw one frame. */

import type { Draft } from "../edit/tools";
import type { FlightState, PlanView, ScenarioView, TrailsView } from "../protocol";
import type { Switches } from "../state/layers";
import type { Highlight, Thing } from "../state/selection";
import type { Camera } from "./camera";
import type { Colors } from "./colors";

export interface Frame {
  readonly camera: Camera;
  /** [steps], with fractions. */
  readonly time: number;
  readonly colors: Colors;
  /** Color of each vehicle drawn, in their order: of the plan's tracks where there is a plan. */
  readonly vehicleColors: readonly string[];
  /** Color of each vehicle of the scenario, which may be others than the plan's. */
  readonly scenarioColors: readonly string[];
  readonly scenario: ScenarioView | null;
  readonly plan: PlanView | null;
  /** Whether the scenario has been changed since the plan was made. */
  readonly isStale: boolean;
  readonly compared: PlanView | null;
  readonly trails: TrailsView | null;
  readonly flight: FlightState | null;
  readonly selected: Thing | null;
  readonly hovered: Thing | null;
  readonly highlight: Highlight | null;
  /** What is being drawn with a tool. */
  readonly draft: Draft | null;
  /** Which of the selected thing's handles the keys move. */
  readonly activeHandle: number;
  readonly switches: Switches;
}

/** Draws one kind of thing; pixels are those of the page, the ratio of the device is set already. */
export type Layer = (ctx: CanvasRenderingContext2D, frame: Frame) => void;
