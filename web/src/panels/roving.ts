/** Lists in which Tab stops once and arrows go from entry to entry. */

/** Move the focus among `[data-entry]` within a list; whether the key was one of its own. */
export function rove(event: KeyboardEvent): boolean {
  const list = event.currentTarget;
  if (!(list instanceof HTMLElement)) return false;
  const entries = [...list.querySelectorAll<HTMLElement>("[data-entry]")];
  // In notebooks the root is that of the view.
  const { activeElement } = list.getRootNode() as Document | ShadowRoot;
  const here = entries.findIndex((entry) => entry.contains(activeElement));
  const to = target(event.key, here, entries.length);
  if (to === null) return false;
  event.preventDefault();
  event.stopPropagation();
  entries[to]?.focus();
  return true;
}

function target(key: string, here: number, length: number): number | null {
  if (length === 0) return null;
  switch (key) {
    case "ArrowDown":
      return Math.min(here + 1, length - 1);
    case "ArrowUp":
      return Math.max(here - 1, 0);
    case "Home":
      return 0;
    case "End":
      return length - 1;
    default:
      return null;
  }
}
