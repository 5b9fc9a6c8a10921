/** Handles of what is selected, and what is being drawn. */

import type { Handle } from "../../protocol";
import { isWhole } from "../../edit/drag";
import { goalAt, handlesOf } from "../../edit/things";
import { num } from "../geometry";
import type { Frame, Layer } from "../frame";

export const drawHandles: Layer = (ctx, frame) => {
  const { scenario, selected, colors } = frame;
  if (scenario === null || selected === null) return;
  const visited = goalAt(scenario, selected.path);
  if (visited !== null) {
    const [px, top] = frame.camera.toScreen(num(visited.box.min, 0), num(visited.box.max, 1));
    const [right, bottom] = frame.camera.toScreen(num(visited.box.max, 0), num(visited.box.min, 1));
    ctx.strokeStyle = colors.accent;
    ctx.lineWidth = 2;
    ctx.strokeRect(px, top, right - px, bottom - top);
  }
  const handles = handlesOf(scenario, selected);
  handles.forEach((handle, i) => drawHandle(ctx, frame, handle, i));
};

function drawHandle(ctx: CanvasRenderingContext2D, frame: Frame, handle: Handle, index: number): void {
  const { camera, colors } = frame;
  const px = Math.round(camera.px(num(handle.at, 0)));
  const py = Math.round(camera.py(num(handle.at, 1)));
  const isActive = index === frame.activeHandle;
  ctx.fillStyle = isActive ? colors.accent : colors.ground;
  ctx.strokeStyle = colors.accent;
  ctx.lineWidth = 1.5;
  ctx.beginPath();
  // Round ones move the whole, square ones a corner.
  if (isWhole(handle) || (index === 0 && frame.selected?.kind !== "workspace")) ctx.arc(px, py, 5, 0, 2 * Math.PI);
  else ctx.rect(px - 4, py - 4, 8, 8);
  ctx.fill();
  ctx.stroke();
}

export const drawDraft: Layer = (ctx, frame) => {
  const { draft, camera, colors } = frame;
  if (draft === null) return;
  const { points, cursor } = draft;
  ctx.strokeStyle = colors.accent;
  ctx.fillStyle = colors.accent;
  ctx.lineWidth = 1.5;
  const all = cursor === null ? points : [...points, cursor];
  ctx.beginPath();
  if (draft.tool === "box" && all.length === 2) {
    const [[ax, ay], [bx, by]] = all as [readonly [number, number], readonly [number, number]];
    ctx.rect(camera.px(ax), camera.py(ay), (bx - ax) * camera.scale, (ay - by) * camera.scale);
  } else {
    all.forEach(([x, y], i) => {
      if (i === 0) ctx.moveTo(camera.px(x), camera.py(y));
      else ctx.lineTo(camera.px(x), camera.py(y));
    });
    if (draft.tool === "polygon") ctx.closePath();
  }
  ctx.setLineDash([4, 3]);
  if (draft.tool === "polygon" || draft.tool === "box") {
    ctx.globalAlpha = 0.12;
    ctx.fill();
    ctx.globalAlpha = 1;
  }
  ctx.stroke();
  ctx.setLineDash([]);
  ctx.beginPath();
  for (const [x, y] of points) {
    ctx.moveTo(camera.px(x) + 3, camera.py(y));
    ctx.arc(camera.px(x), camera.py(y), 3, 0, 2 * Math.PI);
  }
  ctx.fill();
  if (cursor !== null) drawCross(ctx, camera.px(cursor[0]), camera.py(cursor[1]));
};

function drawCross(ctx: CanvasRenderingContext2D, px: number, py: number): void {
  ctx.lineWidth = 1;
  ctx.beginPath();
  ctx.moveTo(px - 8, py);
  ctx.lineTo(px + 8, py);
  ctx.moveTo(px, py - 8);
  ctx.lineTo(px, py + 8);
  ctx.stroke();
}
