/** "Why not", at the place: remarks with cures as buttons. */

import type { Cure, Remark } from "../protocol";
import { Block, Button, Empty } from "./controls";
import { counted } from "./format";
import { rove } from "./roving";

export interface WhyProps {
  /** What `check` says, and what was found out about a plan that is missing or over Δ. */
  readonly remarks: readonly Remark[];
  /** Sentences of what was tried: the search, and how it ended. */
  readonly tried: readonly string[];
  /** Whether the server is looking for what stands in the way. */
  readonly isLooking: boolean;
  readonly canLook: boolean;
  readonly onLook: () => void;
  readonly onCure: (cure: Cure) => void;
  /** Pointed at, or left: null. */
  readonly onPoint: (remark: Remark | null) => void;
  /** Chosen: the map goes there. */
  readonly onGo: (remark: Remark) => void;
}

const ORDER: Readonly<Record<Remark["severity"], number>> = { error: 0, fatal: 1, warning: 2 };

const WORDS: Readonly<Record<Remark["severity"], string>> = {
  error: "error",
  fatal: "rules out any plan",
  warning: "warning",
};

export function Why(props: WhyProps) {
  const { remarks, tried } = props;
  const sorted = [...remarks].sort((a, b) => ORDER[a.severity] - ORDER[b.severity]);
  return (
    <Block title="Why not" aside={<span class="p-count">{remarks.length}</span>}>
      {tried.map((sentence) => (
        <p key={sentence} class="p-note">
          {sentence}
        </p>
      ))}
      {remarks.length === 0 && tried.length === 0 && <Empty>Nothing is known to stand in the way.</Empty>}
      <ul class="p-remarks" aria-label={counted(remarks.length, "remark")} onKeyDown={rove}>
        {sorted.map((remark, i) => (
          <Entry key={`${i} ${remark.text}`} remark={remark} isFirst={i === 0} {...props} />
        ))}
      </ul>
      <div class="p-actions">
        <Button onClick={props.onLook} disabled={!props.canLook || props.isLooking}>
          {props.isLooking ? "Trying cures…" : "Find out, trying cures"}
        </Button>
        <span class="p-note">{props.isLooking ? "takes some seconds" : ""}</span>
      </div>
    </Block>
  );
}

function Entry(props: WhyProps & { remark: Remark; isFirst: boolean }) {
  const { remark, onPoint } = props;
  return (
    <li class={`p-remark p-${remark.severity}`} onMouseEnter={() => onPoint(remark)} onMouseLeave={() => onPoint(null)}>
      <button type="button" class="p-entry" data-entry tabIndex={props.isFirst ? 0 : -1} onFocus={() => onPoint(remark)} onBlur={() => onPoint(null)} onClick={() => props.onGo(remark)}>
        <span class="p-severity">{WORDS[remark.severity]}</span>
        {remark.text}
      </button>
      {remark.cures.length > 0 && (
        <div class="p-actions">
          {remark.cures.map((cure) => (
            <Button key={cure.label} onClick={() => props.onCure(cure)}>
              {cure.label}
            </Button>
          ))}
        </div>
      )}
    </li>
  );
}
