/** Where names of vehicles stand in a picture of space: beside them, and never over one another. */

import { around, type Spot, Taken } from "../scene/placing";

/** A vehicle on the screen [px], how far away it is, and how wide its name. */
export interface Mark {
  readonly px: number;
  readonly py: number;
  readonly radius: number;
  readonly away: number;
  readonly width: number;
}

export const HIGH = 11; // of a text [px]

const ORDER = [4, 5, 0, 1, 2, 3]; // of the places around it: those that hide the least of it first

/** Number of names in sight up to which they are written however small the picture is. */
const MAX_NAMES = 40;

/** Room in the picture that each of more has at least [px²]. */
const ROOM = 4000;

/**
 * Places for names, the nearest vehicle's first; null for a name that would lie on another.
 *
 * Names keep off vehicles, too, where there is a place that does.
 */
export function namePlaces(marks: readonly Mark[], texts: readonly Spot[], area: number): readonly (Spot | null)[] {
  const places: (Spot | null)[] = marks.map(() => null);
  if (marks.length > MAX_NAMES && marks.length * ROOM > area) return places;
  const [vehicles, written] = [new Taken(), new Taken()];
  for (const spot of texts) written.add(spot);
  for (const { px, py, radius } of marks) {
    vehicles.add({ left: px - radius, top: py - radius, width: 2 * radius, height: 2 * radius });
  }
  const nearest = [...marks.keys()].sort((one, other) => (marks[one]?.away ?? 0) - (marks[other]?.away ?? 0));
  for (const index of nearest) {
    const mark = marks[index];
    if (mark === undefined) continue;
    const beside = around(mark.px, mark.py, mark.radius, mark.width, HIGH);
    const spots = ORDER.flatMap((place) => beside[place] ?? []);
    const free = spots.filter((spot) => written.isFree(spot));
    const spot = free.find((one) => vehicles.isFree(one)) ?? free[0];
    if (spot === undefined) continue;
    places[index] = spot;
    written.add(spot);
  }
  return places;
}
