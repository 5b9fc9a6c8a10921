/** What things are called where they are pointed at. */

import type { ObstacleView, PlanView, VehicleView } from "../protocol";

/** Standard deviations that uncertain places are drawn with where no plan states a level. */
const SIGMAS = 3;

export function sigmasOf(plan: PlanView | null): number {
  return plan?.sigmas ?? SIGMAS;
}

export function vehicleWords({ name, radius }: VehicleView): string {
  return `${name}, radius ${short(radius)} m`;
}

export function obstacleWords(obstacle: ObstacleView, plan: PlanView | null): string {
  const what = obstacle.moving !== null ? ", moving" : obstacle.kind === "line" ? ", a line" : "";
  const where = `, place uncertain: drawn with ${short(sigmasOf(plan))} standard deviations`;
  const whom = obstacle.only === null ? "" : `, ${obstacle.only}`;
  return `${obstacle.name}${what}${whom}${obstacle.uncertain === null ? "" : where}`;
}

export function short(value: number): number {
  return Number(value.toPrecision(4));
}
