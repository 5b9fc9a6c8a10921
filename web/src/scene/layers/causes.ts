/** How causes of risk look on the map: a sign and a color each, those of the ledger beside it. */

import type { LedgerLine } from "../../protocol";

export type Cause = LedgerLine["cause"];

const LIGHT: Readonly<Record<Cause, string>> = { pair: "#A8437E", obstacle: "#C25400", workspace: "#00785A", range: "#2A5FB4" };
const DARK: Readonly<Record<Cause, string>> = { pair: "#DE97BD", obstacle: "#F08544", workspace: "#2FBF96", range: "#86B1F2" };

export function causeColor(cause: Cause, isDark: boolean): string {
  return (isDark ? DARK : LIGHT)[cause];
}

/** Add the sign of a cause to the path: a disc, a square, a diamond or a triangle of the same area. */
export function addSign(ctx: CanvasRenderingContext2D, cause: Cause, px: number, py: number, radius: number): void {
  const half = radius * 0.886;
  const point = radius * 1.2533;
  switch (cause) {
    case "pair":
      ctx.moveTo(px + radius, py);
      ctx.arc(px, py, radius, 0, 2 * Math.PI);
      break;
    case "obstacle":
      ctx.rect(px - half, py - half, 2 * half, 2 * half);
      break;
    case "workspace":
      ctx.moveTo(px, py - point);
      ctx.lineTo(px + point, py);
      ctx.lineTo(px, py + point);
      ctx.lineTo(px - point, py);
      ctx.closePath();
      break;
    case "range":
      ctx.moveTo(px, py - 1.5551 * radius);
      ctx.lineTo(px + 1.3468 * radius, py + 0.7776 * radius);
      ctx.lineTo(px - 1.3468 * radius, py + 0.7776 * radius);
      ctx.closePath();
      break;
  }
}
