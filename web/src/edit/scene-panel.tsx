/** The tab of the scene: what is wrong, all things, properties of the selected one. */

import { useComputed } from "@preact/signals";
import { document, remarks } from "../state/document";
import { selected } from "../state/selection";
import { whyEmpty } from "../state/session";
import { startsWith } from "./paths";
import { Outline } from "./outline";
import { Properties } from "./properties";
import { RemarkLine } from "./remarks";

/** Remarks listed at most. */
const MAX_REMARKS = 20;

export function ScenePanel() {
  const isOpen = useComputed(() => document.value !== null).value;
  if (!isOpen) return <p class="empty">{whyEmpty()}</p>;
  return (
    <>
      <RemarkList />
      <Outline />
      <Properties />
    </>
  );
}

function RemarkList() {
  // Those on the selected thing stand at its fields.
  const { value: thing } = selected;
  const all = thing === null ? remarks.value : remarks.value.filter((remark) => !startsWith(remark.path, thing.path));
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
