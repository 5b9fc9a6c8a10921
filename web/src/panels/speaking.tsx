/** What screen readers are told while something goes on, without chatter. */

import { useEffect, useRef, useState } from "preact/hooks";

/** Between two sentences [ms]: what comes faster is replaced by what comes last. */
const PAUSE = 4000;

/** Says its text when it changes, at most every few seconds; `urgent` says it at once. */
export function Speaker(props: { text: string; urgent?: boolean }) {
  const [said, setSaid] = useState("");
  const last = useRef(-PAUSE);
  useEffect(() => {
    const now = performance.now();
    const pause = props.urgent === true ? 0 : Math.max(0, last.current + PAUSE - now);
    const timer = setTimeout(() => {
      last.current = performance.now();
      setSaid(props.text);
    }, pause);
    return () => clearTimeout(timer);
  }, [props.text, props.urgent]);
  return (
    <p class="p-heard" role="status" aria-live="polite">
      {said}
    </p>
  );
}
