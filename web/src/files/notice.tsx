/** What was done, or went wrong, in one line. */

import { notice } from "../state/session";

/** In a dialog, too: what is below one can be neither reached nor heard. */
export function NoticeLine() {
  const now = notice.value;
  if (now === null) return null;
  return (
    <div class={now.isError ? "notice error" : "notice"} role={now.isError ? "alert" : "status"}>
      <span>{now.text}</span>
      <button type="button" class="plain" aria-label="Dismiss" onClick={() => (notice.value = null)}>
        ×
      </button>
    </div>
  );
}
