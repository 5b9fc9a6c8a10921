/** The place of the map: the plane, or space, which can also be looked at from above. */

import { SpaceRegion } from "../space/region";
import type { Space } from "../space/space";
import { elsewhere } from "./viewport";
import { drawn } from "../state/playback";
import { isFromAbove } from "../state/session";
import { FlatMap } from "./map";
import { currentFrame } from "./painter";

export function Scene() {
  const isSpace = drawn.value?.dimension === 3;
  if (!isSpace) return <FlatMap />;
  return (
    <>
      {isFromAbove.value ? <FlatMap /> : <SpaceMap />}
      <button type="button" class="turn" onClick={() => (isFromAbove.value = !isFromAbove.value)}>
        {isFromAbove.value ? "In space" : "From above"}
      </button>
    </>
  );
}

function SpaceMap() {
  const { scenario, ...frame } = currentFrame();
  return scenario === null ? null : <SpaceRegion frame={{ ...frame, scenario }} onSpace={isLooking} />;
}

/** The buttons that zoom do so in space, while it is looked at. */
function isLooking(space: Space | null): void {
  elsewhere.value = space;
}
