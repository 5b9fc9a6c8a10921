/** Where Δ is used: a sign at each place, its area the share of Δ, labeled when pointed at. */

import type { LedgerLine, PlanView } from "../../protocol";
import { between, CAUSES } from "../../panels/ledger";
import { percentUp, share } from "../../panels/format";
import type { Camera } from "../camera";
import type { Frame, Layer } from "../frame";
import { addSign, causeColor } from "./causes";

/** Shares of Δ below this are not drawn [-]. */
const WORTH = 2e-3;

/** Signs drawn at most: those that risk most. */
const MOST = 400;

/** Radius of a sign that takes all of Δ, and of one that takes nothing [px]. */
const WHOLE = 26;
const LEAST = 3;

/** A place where some of Δ is used. */
export interface RiskMark {
  readonly line: LedgerLine;
  readonly x: number;
  readonly y: number;
  /** Of Δ. */
  readonly share: number;
}

const known = new WeakMap<PlanView, readonly RiskMark[]>();

/** The places of a plan's ledger that are drawn, the riskiest first. */
export function marksOf(plan: PlanView): readonly RiskMark[] {
  const found = known.get(plan);
  if (found !== undefined) return found;
  const bound = plan.summary.riskBound;
  const made = plan.ledger.flatMap((line): RiskMark[] => {
    const [x, y] = line.at;
    if (x === undefined || y === undefined || line.risk < WORTH * bound) return [];
    return [{ line, x, y, share: line.risk / bound }];
  });
  made.sort((a, b) => b.share - a.share);
  const marks = made.slice(0, MOST);
  known.set(plan, marks);
  return marks;
}

/** What a mark says. */
export function markText(mark: RiskMark): string {
  return `${between(mark.line)}, step ${mark.line.step}: ${percentUp(mark.line.risk)}, ${share(mark.share)} of Δ`;
}

/** The mark at a point of the screen, the nearest of them; null is none. */
export function markAt(plan: PlanView, camera: Camera, px: number, py: number): RiskMark | null {
  let best: RiskMark | null = null;
  let least = Infinity;
  for (const mark of marksOf(plan)) {
    const distance = Math.hypot(camera.px(mark.x) - px, camera.py(mark.y) - py);
    if (distance <= radiusOf(mark) + 2 && distance < least) {
      best = mark;
      least = distance;
    }
  }
  return best;
}

function radiusOf(mark: RiskMark): number {
  return LEAST + (WHOLE - LEAST) * Math.sqrt(Math.min(mark.share, 1));
}

export const drawRisk: Layer = (ctx, frame) => {
  const { plan, switches, highlight } = frame;
  if (plan === null || !switches.risk) return;
  const marks = marksOf(plan);
  const now = marks.filter((mark) => Math.abs(mark.line.step - frame.time) <= 0.5);
  const others = marks.filter((mark) => !now.includes(mark));
  drawMarks(ctx, frame, others, 0.22);
  drawMarks(ctx, frame, now, 0.6);
  if (highlight === null) return;
  const pointed = marks.filter((mark) => isPointedAt(mark, frame));
  drawMarks(ctx, frame, pointed, 0.9);
  // One label: those of neighboring steps would cover each other.
  const [label] = pointed;
  if (label !== undefined) drawLabel(ctx, frame, label);
};

/** Whether a panel points at the mark's place, and at all of its vehicles. */
function isPointedAt(mark: RiskMark, { highlight }: Frame): boolean {
  if (highlight === null) return false;
  const { line } = mark;
  const isThere = highlight.at.some(([x, y]) => x === mark.x && y === mark.y);
  return isThere && highlight.vehicles.includes(line.vehicle);
}

function drawMarks(ctx: CanvasRenderingContext2D, frame: Frame, marks: readonly RiskMark[], alpha: number): void {
  const { camera, colors } = frame;
  for (const cause of CAUSES) {
    ctx.beginPath();
    for (const mark of marks) {
      if (mark.line.cause === cause) addSign(ctx, cause, camera.px(mark.x), camera.py(mark.y), radiusOf(mark));
    }
    ctx.fillStyle = causeColor(cause, colors.isDark);
    ctx.strokeStyle = ctx.fillStyle;
    ctx.lineWidth = 1;
    ctx.globalAlpha = alpha;
    ctx.fill();
    ctx.globalAlpha = Math.min(1, alpha + 0.4);
    ctx.stroke();
  }
  ctx.globalAlpha = 1;
}

function drawLabel(ctx: CanvasRenderingContext2D, { camera, colors }: Frame, mark: RiskMark): void {
  const text = markText(mark);
  ctx.font = "12px system-ui, 'Noto Sans', 'Liberation Sans', sans-serif";
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  const width = ctx.measureText(text).width + 12;
  const right = camera.px(mark.x) + radiusOf(mark) + 8;
  // A label that would leave the map stands on the other side.
  const px = right + width <= camera.width ? right : Math.max(camera.px(mark.x) - radiusOf(mark) - 8 - width, 2);
  const py = camera.py(mark.y);
  ctx.fillStyle = colors.ground;
  ctx.fillRect(px, py - 11, width, 22);
  ctx.strokeStyle = colors.muted;
  ctx.lineWidth = 1;
  ctx.strokeRect(px + 0.5, py - 10.5, width - 1, 21);
  ctx.fillStyle = colors.text;
  ctx.fillText(text, px + 6, py + 0.5);
}
