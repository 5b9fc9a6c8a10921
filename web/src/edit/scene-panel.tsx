/** The tab of the scene: what is wrong, properties, all things. */

import { useComputed } from "@preact/signals";
import { document, remarks } from "../state/document";
import { Outline } from "./outline";
import { Properties } from "./properties";
import { RemarkLine } from "./remarks";

/** Remarks listed at most. */
const MAX_REMARKS = 20;

export function ScenePanel() {
  const isOpen = useComputed(() => document.value !== null).value;
  if (!isOpen) return <p class="empty">Nothing is open.</p>;
  return (
    <>
      <RemarkList />
      <Properties />
      <Outline />
    </>
  );
}

function RemarkList() {
  const all = remarks.value;
  if (all.length === 0) return null;
  return (
    <section aria-label="Remarks" class="remarks">
      {all.slice(0, MAX_REMARKS).map((remark, i) => (
        <RemarkLine key={i} remark={remark} leads />
      ))}
      {all.length > MAX_REMARKS && <p class="muted">and {all.length - MAX_REMARKS} more</p>}
    </section>
  );
}
