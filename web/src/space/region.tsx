/** The place of the map for scenes of three dimensions; what draws them is loaded with the first. */

import { useEffect, useRef, useState } from "preact/hooks";
import type { Space } from "./space";
import type { SpaceFrame } from "./types";

type State = "loading" | "there" | "failed";

/** One module for all regions, which loads once. */
let module: Promise<typeof import("./space")> | null = null;

export interface SpaceRegionProps {
  readonly frame: SpaceFrame;
  /** Loads the module elsewhere than beside the page. */
  readonly load?: () => Promise<typeof import("./space")>;
  /** Told when there is a view, and when there is none any more. */
  readonly onSpace?: (space: Space | null) => void;
}

export function SpaceRegion({ frame, load, onSpace }: SpaceRegionProps) {
  const host = useRef<HTMLDivElement>(null);
  const space = useRef<Space | null>(null);
  const latest = useRef(frame);
  const [state, setState] = useState<State>("loading");
  latest.current = frame;

  useEffect(() => {
    let isHere = true;
    const open = async () => {
      module ??= load ? load() : import("./space");
      const { Space } = await module;
      if (!isHere || host.current === null) return;
      space.current = new Space(host.current);
      space.current.show(latest.current);
      // For who measures what is drawn.
      Object.assign(host.current, { space: space.current });
      onSpace?.(space.current);
      setState("there");
    };
    open().catch(() => {
      module = null;
      if (isHere) setState("failed");
    });
    return () => {
      isHere = false;
      onSpace?.(null);
      space.current?.dispose();
      space.current = null;
    };
  }, []);

  useEffect(() => space.current?.show(frame));

  return (
    <div class="space-host" ref={host}>
      {state === "loading" && <p class="space-note" role="status">Loading the view in space</p>}
      {state === "failed" && (
        <p class="space-note" role="alert">
          The view in space needs WebGL, which this browser does not offer. Panels and timeline show all else.
        </p>
      )}
    </div>
  );
}
