/** What a layer is given to draw one frame. */

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
  /** Color of each vehicle, in their order. */
  readonly vehicleColors: readonly string[];
  readonly scenario: ScenarioView | null;
  readonly plan: PlanView | null;
  readonly compared: PlanView | null;
  readonly trails: TrailsView | null;
  readonly flight: FlightState | null;
  readonly selected: Thing | null;
  readonly hovered: Thing | null;
  readonly highlight: Highlight | null;
  readonly switches: Switches;
}

/** Draws one kind of thing; pixels are those of the page, the ratio of the device is set already. */
export type Layer = (ctx: CanvasRenderingContext2D, frame: Frame) => void;
