/** The map of a notebook's view: the page's layers, to be looked at and not to be changed. */

import { useEffect, useRef, useState } from "preact/hooks";
import type { Box } from "../protocol";
import { Camera } from "../scene/camera";
import type { Frame, Layer } from "../scene/frame";
import { drawGrid, drawGround, drawRulers, drawWorkspace } from "../scene/layers/grid";
import { drawMovingObstacles, drawObstacleMarks, drawObstacles } from "../scene/layers/obstacles";
import { drawRanges } from "../scene/layers/ranges";
import { drawRisk } from "../scene/layers/risk";
import { drawGoals, drawTracks } from "../scene/layers/tracks";
import { drawVehicleMarks, drawVehicles } from "../scene/layers/vehicles";

const LAYERS: readonly Layer[] = [
  drawGround, drawGrid, drawWorkspace, drawObstacles, drawGoals, drawTracks, drawMovingObstacles,
  drawRanges, drawVehicles, drawRisk, drawObstacleMarks, drawVehicleMarks, drawRulers,
];

const MARGIN = 40; // around what is fitted [px]
const PAN = 40; // of a key [px]
const ZOOM = 1.25; // of a key

/** A camera that sees all of a box. */
function fitted(box: Box, width: number, height: number): Camera {
  const at = (corner: readonly number[], axis: number) => corner[axis] ?? 0;
  const dx = Math.max(at(box.max, 0) - at(box.min, 0), 1e-3);
  const dy = Math.max(at(box.max, 1) - at(box.min, 1), 1e-3);
  const scale = Math.min((width - 2 * MARGIN) / dx, (height - 2 * MARGIN) / dy);
  const [x, y] = [0, 1].map((axis) => (at(box.min, axis) + at(box.max, axis)) / 2);
  return new Camera(x ?? 0, y ?? 0, Math.max(scale, 1e-3), width, height);
}

const KEYS: Readonly<Record<string, (camera: Camera) => Camera>> = {
  ArrowLeft: (camera) => camera.panned(PAN, 0),
  ArrowRight: (camera) => camera.panned(-PAN, 0),
  ArrowUp: (camera) => camera.panned(0, PAN),
  ArrowDown: (camera) => camera.panned(0, -PAN),
  "+": (camera) => camera.zoomed(ZOOM, camera.width / 2, camera.height / 2),
  "=": (camera) => camera.zoomed(ZOOM, camera.width / 2, camera.height / 2),
  "-": (camera) => camera.zoomed(1 / ZOOM, camera.width / 2, camera.height / 2),
};

export type Still = Omit<Frame, "camera"> & { readonly scenario: NonNullable<Frame["scenario"]> };

export function NotebookMap({ frame }: { readonly frame: Still }) {
  const host = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const [camera, setCamera] = useState<Camera | null>(null);
  const { extent } = frame.scenario;

  useEffect(() => {
    const element = host.current;
    if (element === null) return;
    const observer = new ResizeObserver(() => {
      const { clientWidth: width, clientHeight: height } = element;
      if (width < 2 || height < 2) return;
      setCamera((now) => now?.resized(width, height) ?? fitted(extent, width, height));
    });
    observer.observe(element);
    // As a listener of its own: one that may keep the notebook from scrolling.
    const wheel = (event: WheelEvent) => {
      if (!event.ctrlKey && !event.metaKey && !element.contains((element.getRootNode() as ShadowRoot).activeElement)) return;
      event.preventDefault();
      const bounds = element.getBoundingClientRect();
      const factor = Math.exp(-event.deltaY / 400);
      setCamera((now) => now?.zoomed(factor, event.clientX - bounds.left, event.clientY - bounds.top) ?? null);
    };
    element.addEventListener("wheel", wheel, { passive: false });
    return () => {
      observer.disconnect();
      element.removeEventListener("wheel", wheel);
    };
  }, [extent]);

  useEffect(() => {
    const context = canvas.current?.getContext("2d");
    if (camera === null || canvas.current === null || context == null) return;
    const ratio = window.devicePixelRatio;
    canvas.current.width = Math.round(camera.width * ratio);
    canvas.current.height = Math.round(camera.height * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    for (const layer of LAYERS) layer(context, { ...frame, camera });
  });

  return (
    <div
      ref={host}
      class="n-map"
      role="application"
      aria-roledescription="map"
      aria-label={`Map of ${frame.scenario.name}. Arrows move, + and − zoom, 0 shows all.`}
      tabIndex={0}
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={(event) => {
        const [dx, dy] = [event.movementX, event.movementY];
        if (event.buttons !== 0) setCamera((now) => now?.panned(dx, dy) ?? null);
      }}
      onKeyDown={(event) => {
        const act = KEYS[event.key];
        const isAll = event.key === "0" && camera !== null;
        if (act === undefined && !isAll) return;
        // The notebook has keys of its own.
        event.preventDefault();
        event.stopPropagation();
        if (act !== undefined) setCamera((now) => (now === null ? null : act(now)));
        else if (camera !== null) setCamera(fitted(extent, camera.width, camera.height));
      }}
    >
      <canvas ref={canvas} aria-hidden="true" />
    </div>
  );
}
