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

/** A text with as many letters left out of its middle as it takes to fit: names differ at their ends. */
export function shortened(text: string, fits: (text: string) => boolean): string {
  if (fits(text)) return text;
  const letters = Array.from(new Intl.Segmenter().segment(text), ({ segment }) => segment);
  const keeping = (count: number) => {
    const front = Math.ceil(count / 2);
    return `${letters.slice(0, front).join("").trimEnd()}…${letters.slice(letters.length - count + front).join("").trimStart()}`;
  };
  let [most, tooMany] = [2, letters.length];
  while (tooMany - most > 1) {
    const count = (most + tooMany) >> 1;
    if (fits(keeping(count))) most = count;
    else tooMany = count;
  }
  return keeping(most);
}

/** Places in an area [px], those first that are all within it. */
export function insideFirst(spots: readonly Spot[], { width, height }: Pick<Spot, "width" | "height">): readonly Spot[] {
  const isIn = (spot: Spot) =>
    spot.left >= 0 && spot.top >= 0 && spot.left + spot.width <= width && spot.top + spot.height <= height;
  return [...spots.filter(isIn), ...spots.filter((spot) => !isIn(spot))];
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
