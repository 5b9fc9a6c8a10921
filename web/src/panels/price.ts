/**
 * What a scenario's plan would cost at another Δ, from plans already found.
 *
 * A plan certified at risk r serves every Δ ≥ r: what it costs is an upper bound there, and the
 * least of them is what is known for sure. Between plans the cost is estimated: it falls about
 * linearly in log Δ, with the shadow price at each plan as slope.
 */

import type { PlanSummary } from "../protocol";

/** A plan on the curve. */
export interface PricePoint {
  readonly plan: string;
  readonly riskBound: number;
  readonly certified: number;
  readonly cost: number;
  /** What a factor of e more of Δ saves [cost]; null where no price is known. */
  readonly slope: number | null;
}

/** A cost at some Δ. */
export interface Priced {
  readonly cost: number;
  /** How it is known: a plan is there, between or beside plans, or only no more than that. */
  readonly kind: "found" | "estimated" | "at most";
}

/** How far beyond the outermost plan an estimate reaches: a factor of Δ. */
export const REACH = 10;

/** Plans of one revision that hold, one per Δ (the cheapest), those left out that another beats. */
export function pricePoints(plans: readonly PlanSummary[], revision: number): readonly PricePoint[] {
  const points: PricePoint[] = [];
  for (const plan of plans) {
    if (plan.revision !== revision || !plan.holds || plan.cost === null || plan.certified === null) continue;
    points.push({
      plan: plan.plan,
      riskBound: plan.riskBound,
      certified: plan.certified,
      cost: plan.cost,
      slope: plan.price === null ? null : plan.price * plan.riskBound,
    });
  }
  points.sort((a, b) => a.riskBound - b.riskBound || a.cost - b.cost);
  let least = Infinity;
  const kept: PricePoint[] = [];
  for (const point of points) {
    if (point.cost >= least) continue;
    least = point.cost;
    kept.push(point);
  }
  return kept;
}

/** What is known for sure: the least cost of a plan whose certificate is within Δ. */
export function atMost(points: readonly PricePoint[], riskBound: number): number | null {
  const costs = points.filter((point) => point.certified <= riskBound).map((point) => point.cost);
  return costs.length === 0 ? null : Math.min(...costs);
}

/** The cost at some Δ as well as it is known; null where nothing is. */
export function priced(points: readonly PricePoint[], riskBound: number): Priced | null {
  const here = points.find((point) => Math.abs(Math.log(point.riskBound / riskBound)) < 1e-3);
  if (here !== undefined) return { cost: here.cost, kind: "found" };
  const estimate = estimated(points, riskBound);
  const most = atMost(points, riskBound);
  if (estimate === null) return most === null ? null : { cost: most, kind: "at most" };
  return { cost: most === null ? estimate : Math.min(most, estimate), kind: "estimated" };
}

/** The curve through the plans, in log Δ: monotone cubics between them, tangents beside them. */
export function estimated(points: readonly PricePoint[], riskBound: number): number | null {
  const [first] = points;
  const last = points.at(-1);
  if (first === undefined || last === undefined) return null;
  if (riskBound <= first.riskBound) return tangent(first, riskBound);
  if (riskBound >= last.riskBound) return tangent(last, riskBound);
  const next = points.findIndex((point) => point.riskBound > riskBound);
  const left = points[next - 1] ?? first;
  const right = points[next] ?? last;
  return hermite(left, right, riskBound);
}

function tangent(point: PricePoint, riskBound: number): number | null {
  const distance = Math.log(riskBound / point.riskBound);
  if (point.slope === null || Math.abs(distance) > Math.log(REACH) + 1e-9) return null;
  return point.cost - point.slope * distance;
}

function hermite(left: PricePoint, right: PricePoint, riskBound: number): number {
  const width = Math.log(right.riskBound / left.riskBound);
  const t = Math.log(riskBound / left.riskBound) / width;
  const secant = (right.cost - left.cost) / width;
  // Slopes beyond three times the secant's would let the curve rise again (Fritsch and Carlson).
  const slope = (point: PricePoint): number =>
    point.slope === null ? secant : Math.max(-point.slope, 3 * secant);
  const t2 = t * t;
  const t3 = t2 * t;
  return (
    (2 * t3 - 3 * t2 + 1) * left.cost +
    (t3 - 2 * t2 + t) * width * slope(left) +
    (3 * t2 - 2 * t3) * right.cost +
    (t3 - t2) * width * slope(right)
  );
}
