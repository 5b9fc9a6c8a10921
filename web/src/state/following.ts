/** Where things of a document are once it has changed: places in lists change, names seldom. */

import type { Document, Json, Path } from "../protocol";
import { isList, isMapping } from "../edit/paths";

/** The path of the same thing in a changed document; null where it is gone. */
export function followed(before: Document, after: Document, path: Path): Path | null {
  let from: Json | undefined = before;
  let to: Json | undefined = after;
  const found: (string | number)[] = [];
  for (const key of path) {
    let place = key;
    if (typeof key === "number" && isList(from) && isList(to)) {
      const now = placeOf(from, to, key);
      if (now === null) return null;
      place = now;
    }
    found.push(place);
    from = isList(from) ? from[Number(key)] : isMapping(from) ? from[key] : undefined;
    to = isList(to) ? to[Number(place)] : isMapping(to) ? to[place] : undefined;
  }
  return found;
}

/** What is appended stays so; numbers are told apart by their places, the rest by names or by all of it. */
function placeOf(before: readonly Json[], after: readonly Json[], index: number): number | null {
  const item = before[index];
  if (item === undefined) return after.length;
  if (typeof item !== "object") return index;
  const key = keyOf(item);
  const same = after[index];
  if (same !== undefined && keyOf(same) === key) return index;
  const moved = after.findIndex((other) => keyOf(other) === key);
  if (moved >= 0) return moved;
  // Changed at its place, such as renamed.
  const isNew = same !== undefined && before.every((other) => keyOf(other) !== keyOf(same));
  return before.length === after.length && isNew ? index : null;
}

function keyOf(item: Json): string {
  const name = isMapping(item) ? item["name"] : undefined;
  return typeof name === "string" ? `name ${name}` : JSON.stringify(item);
}
