/** Reading plain data by paths. */

import type { Json, Path } from "../protocol";

/** The value at a path; undefined where there is none. */
export function get(root: Json | undefined, path: Path): Json | undefined {
  let node: Json | undefined = root;
  for (const key of path) {
    if (Array.isArray(node)) node = (node as readonly Json[])[Number(key)];
    else if (isMapping(node)) node = node[key];
    else return undefined;
  }
  return node;
}

export function isMapping(value: Json | undefined): value is { readonly [key: string]: Json } {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

export function isList(value: Json | undefined): value is readonly Json[] {
  return Array.isArray(value);
}

/** A path as one text, for comparing and as a key. */
export function keyOf(path: Path): string {
  return path.join("\u0000");
}

export function startsWith(path: Path, start: Path): boolean {
  return start.length <= path.length && start.every((key, i) => key === path[i]);
}

/** A number without the noise of its last binary digits. */
export function clean(value: number): number {
  return Number(value.toPrecision(12));
}
