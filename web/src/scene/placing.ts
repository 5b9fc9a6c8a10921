/** Texts side by side: each takes the first of its places that nothing stands in yet. */

/** A rectangle on the screen [px]. */
export interface Spot {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

const AIR = 1; // between two texts [px]

export class Taken {
  readonly #spots: Spot[] = [];

  /** Keeps others from a place. */
  add(spot: Spot): void {
    this.#spots.push(spot);
  }

  /** Whether nothing stands in a place yet. */
  isFree(spot: Spot): boolean {
    return this.#spots.every((other) => !overlap(spot, other));
  }

  /** Takes the first that is free, and returns it; null where none is. */
  claim(spots: readonly Spot[]): Spot | null {
    const free = spots.find((spot) => this.isFree(spot));
    if (free === undefined) return null;
    this.#spots.push(free);
    return free;
  }
}

function overlap(one: Spot, other: Spot): boolean {
  return (
    one.left < other.left + other.width + AIR && other.left < one.left + one.width + AIR
    && one.top < other.top + other.height + AIR && other.top < one.top + one.height + AIR
  );
}

/** Places of a text around a disc: on its right, its left, above and below. */
export function around(px: number, py: number, radius: number, width: number, height: number): readonly Spot[] {
  const [away, size] = [radius + 4, { width, height }];
  const [middle, center] = [py - height / 2, px - width / 2];
  return [
    { left: px + away, top: middle, ...size },
    { left: px - away - width, top: middle, ...size },
    { left: center, top: py - away - height, ...size },
    { left: center, top: py + away, ...size },
    { left: px + away, top: py - away - height, ...size },
    { left: px + away, top: py + away, ...size },
  ];
}
