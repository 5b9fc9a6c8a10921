/** Ground, grid with coordinates, scale bar. */

import type { Camera } from "../camera";
import type { Frame, Layer } from "../frame";

/** Least distance of numbered lines [px]. */
const SPACING = 90;

/** Left free between coordinates and the scale bar [px]. */
const GAP = 14;

const FONT = "10px ui-monospace, 'SF Mono', 'Cascadia Mono', 'DejaVu Sans Mono', monospace";

/** A round number of meters that is at least so many pixels. */
export function roundStep(scale: number, pixels: number): number {
  const least = pixels / scale;
  const power = 10 ** Math.floor(Math.log10(least));
  const factor = [1, 2, 5, 10].find((candidate) => candidate * power >= least) ?? 10;
  return factor * power;
}

/** A length in m or km, as few digits as it takes. */
export function lengthText(meters: number): string {
  if (meters >= 1000) return `${meters / 1000} km`;
  return `${Number(meters.toPrecision(6))} m`;
}

export const drawGround: Layer = (ctx, frame) => {
  const { camera, colors, scenario } = frame;
  ctx.fillStyle = scenario?.workspace === null || scenario === null ? colors.ground : colors.outside;
  ctx.fillRect(0, 0, camera.width, camera.height);
  if (scenario?.workspace == null) return;
  const [minX = 0, minY = 0] = scenario.workspace.min;
  const [maxX = 0, maxY = 0] = scenario.workspace.max;
  ctx.fillStyle = colors.ground;
  ctx.fillRect(camera.px(minX), camera.py(maxY), (maxX - minX) * camera.scale, (maxY - minY) * camera.scale);
};

export const drawGrid: Layer = (ctx, frame) => {
  const { camera, colors } = frame;
  const step = roundStep(camera.scale, SPACING);
  ctx.lineWidth = 1;
  strokeLines(ctx, camera, step / 5, colors.grid);
  strokeLines(ctx, camera, step, colors.gridStrong);
};

function strokeLines(ctx: CanvasRenderingContext2D, camera: Camera, step: number, color: string): void {
  const [left, top] = camera.toMap(0, 0);
  const [right, bottom] = camera.toMap(camera.width, camera.height);
  ctx.strokeStyle = color;
  ctx.beginPath();
  for (let i = Math.ceil(left / step); i * step <= right; i += 1) {
    const px = Math.round(camera.px(i * step)) + 0.5;
    ctx.moveTo(px, 0);
    ctx.lineTo(px, camera.height);
  }
  for (let i = Math.ceil(bottom / step); i * step <= top; i += 1) {
    const py = Math.round(camera.py(i * step)) + 0.5;
    ctx.moveTo(0, py);
    ctx.lineTo(camera.width, py);
  }
  ctx.stroke();
}

export const drawWorkspace: Layer = (ctx, frame) => {
  const box = frame.scenario?.workspace;
  if (box == null) return;
  const { camera, colors, selected } = frame;
  const [minX = 0, minY = 0] = box.min;
  const [maxX = 0, maxY = 0] = box.max;
  ctx.strokeStyle = selected?.kind === "workspace" ? colors.accent : colors.muted;
  ctx.lineWidth = selected?.kind === "workspace" ? 2 : 1;
  ctx.strokeRect(camera.px(minX), camera.py(maxY), (maxX - minX) * camera.scale, (maxY - minY) * camera.scale);
};

/** Coordinates along the left and the lower edge, the scale bar at the lower right. */
export const drawRulers: Layer = (ctx, frame) => {
  const { camera, colors } = frame;
  const step = roundStep(camera.scale, SPACING);
  const digits = Math.max(0, -Math.floor(Math.log10(step)));
  const [left, top] = camera.toMap(0, 0);
  const [right, bottom] = camera.toMap(camera.width, camera.height);
  ctx.font = FONT;
  ctx.fillStyle = colors.muted;
  ctx.strokeStyle = colors.ground;
  ctx.lineWidth = 3;
  ctx.textAlign = "center";
  ctx.textBaseline = "alphabetic";
  const end = startOfBar(ctx, camera) - GAP;
  for (let i = Math.ceil(left / step); i * step <= right; i += 1) {
    const px = camera.px(i * step);
    if (px > 30 && px + ctx.measureText((i * step).toFixed(digits)).width / 2 < end) label(ctx, (i * step).toFixed(digits), px, camera.height - 5);
  }
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  for (let i = Math.ceil(bottom / step); i * step <= top; i += 1) {
    const py = camera.py(i * step);
    if (py > 20 && py < camera.height - 24) label(ctx, (i * step).toFixed(digits), 5, py);
  }
  drawScaleBar(ctx, frame);
};

/** Length of the scale bar [m]. */
function barOf(camera: Camera): number {
  return roundStep(camera.scale, 50);
}

/** Where the scale bar begins with its length [px]. */
function startOfBar(ctx: CanvasRenderingContext2D, camera: Camera): number {
  const length = barOf(camera);
  return camera.width - 18 - length * camera.scale - ctx.measureText(lengthText(length)).width;
}

function drawScaleBar(ctx: CanvasRenderingContext2D, { camera, colors }: Frame): void {
  const length = barOf(camera);
  const width = length * camera.scale;
  const right = camera.width - 12;
  const y = camera.height - 8.5;
  ctx.textAlign = "right";
  ctx.textBaseline = "alphabetic";
  label(ctx, lengthText(length), right - width - 6, camera.height - 5);
  ctx.strokeStyle = colors.text;
  ctx.lineWidth = 1;
  ctx.beginPath();
  ctx.moveTo(right - width, y - 4);
  ctx.lineTo(right - width, y);
  ctx.lineTo(right, y);
  ctx.lineTo(right, y - 4);
  ctx.stroke();
  ctx.strokeStyle = colors.ground;
}

function label(ctx: CanvasRenderingContext2D, text: string, px: number, py: number): void {
  ctx.lineWidth = 3;
  ctx.strokeText(text, px, py);
  ctx.fillText(text, px, py);
}
