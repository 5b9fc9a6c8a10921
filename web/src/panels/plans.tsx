/** Plans found: which one is on the map, which one it is compared with, saving and exporting. */

import { useId, useState } from "preact/hooks";
import type { Hello, PlanSummary } from "../protocol";
import { Block, Button, Empty } from "./controls";
import { bound, cost, counted, percentUp } from "./format";

/** Plans listed at first: the newest, and those chosen. */
const FIRST = 8;

export interface PlansProps {
  readonly plans: readonly PlanSummary[];
  /** Of the document as it is now. */
  readonly revision: number;
  readonly shown: string | null;
  readonly compared: string | null;
  readonly exports: Hello["exports"];
  /** Path that is proposed for a file of the plan. */
  readonly path: string;
  readonly onShow: (plan: string | null) => void;
  readonly onCompare: (plan: string | null) => void;
  readonly onSave: (plan: string, path: string, overwrite: boolean) => void;
  readonly onExport: (plan: string, format: string) => void;
}

export function Plans(props: PlansProps) {
  const { plans, shown, compared } = props;
  const [all, setAll] = useState(false);
  const name = useId();
  const newest = [...plans].reverse();
  const listed = all ? newest : newest.filter((plan, i) => i < FIRST || plan.plan === shown || plan.plan === compared);
  const hidden = plans.length - listed.length;
  return (
    <Block title="Plans" aside={<span class="p-count">{plans.length}</span>}>
      {plans.length === 0 ? (
        <Empty>None yet. What a search finds is listed here while it runs.</Empty>
      ) : (
        <table class="p-plans">
          <thead>
            <tr>
              <th scope="col">Cost</th>
              <th scope="col">Risk ≤</th>
              <th scope="col">Δ</th>
              <th scope="col">Certificate</th>
              <th scope="col">
                <span class="p-heard">Compare</span>
              </th>
            </tr>
          </thead>
          <tbody>
            {listed.map((plan) => (
              <Row key={plan.plan} plan={plan} name={name} {...props} />
            ))}
          </tbody>
        </table>
      )}
      {hidden > 0 && (
        <Button kind="quiet" onClick={() => setAll(true)}>
          {counted(hidden, "earlier plan")}
        </Button>
      )}
      {shown !== null && plans.some((plan) => plan.plan === shown) && <Files key={props.path} {...props} plan={shown} />}
    </Block>
  );
}

function Row(props: PlansProps & { plan: PlanSummary; name: string }) {
  const { plan, name, shown, compared } = props;
  const isShown = plan.plan === shown;
  const isCompared = plan.plan === compared;
  const isOld = plan.revision !== props.revision;
  const what = plan.cost === null ? "no trajectories" : cost(plan.cost);
  const about = `${plan.planner}, ${plan.status}, ${plan.seconds.toFixed(1)} s${isOld ? ", of an earlier scenario" : ""}`;
  return (
    <tr class={`${isShown ? "p-chosen" : ""} ${isOld ? "p-old" : ""}`} title={about}>
      <th scope="row">
        <label>
          <input type="radio" name={name} checked={isShown} aria-label={`Show: cost ${what}, Δ ${bound(plan.riskBound)}, ${verdict(plan)}, ${about}`} onChange={() => props.onShow(plan.plan)} />
          {plan.cost === null ? "none" : what}
        </label>
      </th>
      <td>{percentUp(plan.certified)}</td>
      <td>{bound(plan.riskBound)}</td>
      <td class={plan.holds ? "p-holds" : "p-fails"}>{verdict(plan)}</td>
      <td>
        {!isShown && shown !== null && plan.cost !== null && (
          <Button kind="quiet" pressed={isCompared} label={`Compare vs cost ${what} at Δ ${bound(plan.riskBound)}`} onClick={() => props.onCompare(isCompared ? null : plan.plan)}>
            vs
          </Button>
        )}
      </td>
    </tr>
  );
}

/** What the referee says of a plan, in a word or two. */
export function verdict(plan: PlanSummary): string {
  if (plan.cost === null) return "no plan";
  return plan.holds ? "holds" : "over Δ";
}

function Files(props: PlansProps & { plan: string }) {
  const id = useId();
  const [path, setPath] = useState(props.path);
  const [replace, setReplace] = useState(false);
  const [format, setFormat] = useState(props.exports[0]?.name ?? "");
  return (
    <details class="p-files">
      <summary>Save or export the plan shown</summary>
      <form
        class="p-actions"
        onSubmit={(event) => {
          event.preventDefault();
          props.onSave(props.plan, path, replace);
        }}
      >
        <label for={`${id}-path`}>File</label>
        <input id={`${id}-path`} class="p-path" value={path} required spellcheck={false} autocomplete="off" onInput={(event) => setPath(event.currentTarget.value)} />
        <button type="submit" class="p-button p-plain">
          Save
        </button>
        <label class="p-toggle">
          <input type="checkbox" checked={replace} onChange={(event) => setReplace(event.currentTarget.checked)} />
          Replace a file of this name
        </label>
      </form>
      {props.exports.length > 0 && (
        <div class="p-actions">
          <label for={`${id}-format`}>Export as</label>
          <select id={`${id}-format`} value={format} onChange={(event) => setFormat(event.currentTarget.value)}>
            {props.exports.map((one) => (
              <option key={one.name} value={one.name}>
                {one.name}
              </option>
            ))}
          </select>
          <Button onClick={() => props.onExport(props.plan, format)}>Export</Button>
          <span class="p-note">{props.exports.find((one) => one.name === format)?.text}</span>
        </div>
      )}
    </details>
  );
}
