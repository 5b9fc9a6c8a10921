/** The map: two canvases, one above the other, with marks and what is under the pointer. */

import { useEffect, useRef } from "preact/hooks";
import { keyOnMap } from "../edit/keyboard";
import { draft, hintOf, tool } from "../edit/tools";
import { isStale } from "../state/plans";
import { drawn } from "../state/playback";
import { Marks } from "./marks";
import { paint } from "./painter";
import { listenTo, pointer } from "./pointer";
import { Tip } from "./tip";
import { resize } from "./viewport";

export function FlatMap() {
  const host = useRef<HTMLDivElement>(null);
  const still = useRef<HTMLCanvasElement>(null);
  const live = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (host.current === null || still.current === null || live.current === null) return;
    const element = host.current;
    const observer = new ResizeObserver(() => resize(element.clientWidth, element.clientHeight));
    observer.observe(element);
    resize(element.clientWidth, element.clientHeight);
    const ends = [paint(still.current, live.current), listenTo(live.current)];
    return () => {
      observer.disconnect();
      for (const end of ends) end();
    };
  }, []);
  const scenario = drawn.value;
  const label =
    scenario === null
      ? "Map, empty"
      : `Map of ${scenario.name}: ${scenario.vehicles.length} vehicles, ${scenario.obstacles.length} obstacles`;
  return (
    <div
      ref={host}
      class="flat"
      id="map"
      role="application"
      aria-label={label}
      aria-describedby="map-keys"
      tabIndex={0}
      onKeyDown={keyOnMap}
    >
      <canvas ref={still} aria-hidden="true" />
      <canvas ref={live} aria-hidden="true" />
      <p id="map-keys" class="unseen">
        Arrow keys pan, or move what is selected; plus and minus zoom; brackets choose a handle; Delete removes;
        Escape lets go.
      </p>
      <Marks />
      <Hint />
      <Position />
      <Tip />
    </div>
  );
}

function Hint() {
  const hint = tool.value === "select" ? "" : hintOf(tool.value, draft.value?.points.length ?? 0);
  const text = hint === "" && isStale.value ? "The scenario was changed after this plan" : hint;
  return (
    <p class="hint" role="status">
      {text}
    </p>
  );
}

/** Coordinates of the pointer, or of the cross that the arrow keys move. */
function Position() {
  const place = draft.value?.cursor ?? pointer.value?.place;
  if (place == null) return null;
  return (
    <output class="position" aria-live="off">
      {place[0]}, {place[1]} m
    </output>
  );
}
