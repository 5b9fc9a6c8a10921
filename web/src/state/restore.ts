/** What a reload brings back beside the document and the camera: tab, selection, plan, time. */

import { effect } from "@preact/signals";
import { shownId } from "./plans";
import { time } from "./playback";
import { selected, type Thing } from "./selection";
import { tab, type Tab } from "./session";

interface Kept {
  readonly tab: Tab;
  readonly selected: Thing | null;
  readonly shown: string | null;
  readonly time: number;
}

/** What was kept, for the document that is about to be shown again. */
export function kept(): Kept | null {
  const text = sessionStorage.getItem("page");
  return text === null ? null : (JSON.parse(text) as Kept);
}

/** Keep these as they change; called once, after they are read. */
export function restore(): void {
  const before = kept();
  if (before !== null) tab.value = before.tab;
  let timer = 0;
  let isFirst = true;
  effect(() => {
    const now: Kept = { tab: tab.value, selected: selected.value, shown: shownId.value, time: time.value };
    clearTimeout(timer);
    if (isFirst) isFirst = false;
    else timer = window.setTimeout(() => sessionStorage.setItem("page", JSON.stringify(now)), 150);
  });
}
