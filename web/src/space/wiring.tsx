/** The view in space on the page: wired to the state, in the place of the map. */

import { currentFrame } from "../scene/painter";
import { elsewhere } from "../scene/viewport";
import { SpaceRegion } from "./region";
import type { Space } from "./space";

const isLooking = (space: Space | null): void => {
  elsewhere.value = space;
};

export function SpaceMap() {
  const frame = currentFrame();
  const { scenario } = frame;
  return scenario === null ? null : <SpaceRegion frame={{ ...frame, scenario }} onSpace={isLooking} />;
}
