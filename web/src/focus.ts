/** Keeps the focus near its place when what has it goes from the page, or cannot be used for a while. */

const FOCUSABLE = "button, input, select, textarea, summary, a[href], [tabindex]";

/** What had the focus last, and where it was: its place among what could have it, in all that holds it, from within. */
interface Last {
  readonly element: HTMLElement;
  readonly holders: readonly (readonly [holder: Element, place: number])[];
}

let last: Last | null = null;

function isUsable(element: HTMLElement): boolean {
  return element.isConnected && !element.matches(":disabled") && element.getClientRects().length > 0;
}

function usableIn(holder: Element): readonly HTMLElement[] {
  return [...holder.querySelectorAll<HTMLElement>(FOCUSABLE)].filter(isUsable);
}

/** Parts of the page hand nothing on to one another: a dialog gives the focus back by itself. */
function lastOf(element: HTMLElement, page: Element | null): Last {
  const holders: [Element, number][] = [];
  for (let holder = element.parentElement; holder !== null && holder !== page; holder = holder.parentElement) {
    holders.push([holder, usableIn(holder).indexOf(element)]);
  }
  return { element, holders };
}

/** What comes to be at its place in the least part of the page that has anything left. */
function heirOf({ holders }: Last): HTMLElement | null {
  for (const [holder, place] of holders) {
    if (!holder.isConnected) continue;
    const usable = usableIn(holder);
    const heir = usable[Math.min(place, usable.length - 1)];
    if (heir !== undefined) return heir;
  }
  return null;
}

function hasNone(): boolean {
  return document.activeElement === null || document.activeElement === document.body;
}

/** Give back the focus that nothing has any more. */
function giveBack(): void {
  if (last === null || !hasNone()) return;
  // What is only disabled gets it back once it can be used again.
  if (last.element.isConnected) {
    if (isUsable(last.element)) last.element.focus({ preventScroll: true });
    return;
  }
  heirOf(last)?.focus({ preventScroll: true });
}

/** Keep the focus within what is drawn in `root`; called once. */
export function keepFocus(root: HTMLElement): void {
  root.addEventListener("focusin", ({ target }) => {
    if (target instanceof HTMLElement) last = lastOf(target, root.firstElementChild);
  });
  root.addEventListener("focusout", () =>
    queueMicrotask(() => {
      // What could have kept it was left on purpose.
      if (hasNone() && last !== null && isUsable(last.element)) last = null;
    }),
  );
  new MutationObserver(giveBack).observe(root, {
    childList: true,
    subtree: true,
    attributes: true,
    attributeFilter: ["disabled"],
  });
}
