/** All things of the scenario as a list, which does from the keyboard what the map does by hand. */

import { useComputed, useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { ScenarioView } from "../protocol";
import { document as opened } from "../state/document";
import { hovered, sameThing, selected, type Thing } from "../state/selection";
import { reveal } from "../scene/viewport";
import { addWorkspace, pick } from "./create";
import { nameOf, placeOf, remarksOn, thingsOf } from "./things";

/** Things listed at most; a filter finds the others. */
const MAX_LISTED = 200;

export function Outline() {
  const filter = useSignal("");
  const list = useRef<HTMLUListElement>(null);
  const view = opened.value?.view ?? null;
  const all = useComputed(() => {
    const scenario = opened.value?.view ?? null;
    const wanted = filter.value.trim().toLowerCase();
    if (scenario === null) return [];
    const things = thingsOf(scenario);
    return wanted === "" ? things : things.filter((thing) => nameOf(scenario, thing).toLowerCase().includes(wanted));
  }).value;
  useEffect(() => {
    list.current?.querySelector("[aria-selected=true]")?.scrollIntoView({ block: "nearest" });
  }, [selected.value]);
  if (view === null) return null;
  const listed = all.slice(0, MAX_LISTED);
  const current = listed.findIndex((thing) => sameThing(thing, selected.value));
  const move = (event: KeyboardEvent) => {
    const rows = [...(list.current?.querySelectorAll<HTMLElement>("[role=option]") ?? [])];
    const focused = rows.findIndex((row) => row === event.target);
    const to = targetOf(event.key, current, focused, listed.length);
    const thing = to === null ? undefined : listed[to];
    if (thing === undefined) return;
    event.preventDefault();
    choose(view, thing);
    rows[to ?? 0]?.focus();
  };
  return (
    <section class="outline" aria-label="Things">
      <header class="section">
        <h2>
          {view.vehicles.length} {view.vehicles.length === 1 ? "vehicle" : "vehicles"}, {view.obstacles.length}{" "}
          {view.obstacles.length === 1 ? "obstacle" : "obstacles"}
        </h2>
        {view.workspace === null && (
          <button type="button" class="plain" onClick={() => void addWorkspace()}>
            Add workspace
          </button>
        )}
      </header>
      {(thingsOf(view).length > 12 || filter.value !== "") && (
        <input
          type="search"
          aria-label="Filter things"
          placeholder="Filter"
          value={filter.value}
          onInput={(event) => (filter.value = event.currentTarget.value)}
        />
      )}
      <ul ref={list} role="listbox" aria-label="Things of the scenario" onKeyDown={move}>
        {listed.map((thing, i) => (
          <Row key={thing.path.join(".")} view={view} thing={thing} isFirst={current < 0 && i === 0} />
        ))}
      </ul>
      {all.length > listed.length && <p class="muted">{all.length - listed.length} more; type a name to find them</p>}
      {all.length === 0 && <p class="empty">{filter.value === "" ? "Nothing yet: draw a vehicle (N)." : "No match."}</p>}
    </section>
  );
}

/** Where a key leads from the selected entry; with none, as after its removal, arrows select the one with the focus. */
function targetOf(key: string, current: number, focused: number, count: number): number | null {
  switch (key) {
    case "ArrowDown":
      return Math.min(current < 0 ? focused : current + 1, count - 1);
    case "ArrowUp":
      return Math.max(current < 0 ? focused : current - 1, 0);
    case "Home":
      return 0;
    case "End":
      return count - 1;
    default:
      return null;
  }
}

function choose(view: ScenarioView, thing: Thing): void {
  pick(thing);
  const place = placeOf(view, thing);
  if (place !== null) reveal(place[0] ?? 0, place[1] ?? 0);
}

function Row({ view, thing, isFirst }: { view: ScenarioView; thing: Thing; isFirst: boolean }) {
  const isSelected = sameThing(thing, selected.value);
  const wrong = remarksOn(opened.value?.remarks ?? [], thing.path);
  const place = placeOf(view, thing);
  const isPart = thing.kind === "goal" || thing.kind === "waypoint";
  const name = nameOf(view, thing);
  // What is a vehicle's stands below it, and is only read out with its name.
  const cut = isPart ? name.lastIndexOf(": ") + 2 : 0;
  return (
    <li
      role="option"
      aria-selected={isSelected}
      tabIndex={isSelected || isFirst ? 0 : -1}
      class={isPart ? "part" : ""}
      onClick={() => choose(view, thing)}
      onKeyDown={(event) => {
        if (event.key !== "Enter") return;
        choose(view, thing);
        document.getElementById("map")?.focus();
      }}
      onPointerEnter={() => (hovered.value = thing)}
      onPointerLeave={() => (hovered.value = null)}
    >
      <span>
        {isPart && <span class="unseen">{name.slice(0, cut)}</span>}
        {name.slice(cut)}
      </span>
      {wrong.length > 0 && (
        <span class={wrong.some((each) => each.severity !== "warning") ? "dot error" : "dot"}>
          !<span class="unseen"> {wrong.length} remarks</span>
        </span>
      )}
      <span class="muted number">{place === null ? "" : place.slice(0, 3).map(coordinate).join(", ")}</span>
    </li>
  );
}

function coordinate(value: number): string {
  return String(Number(value.toPrecision(5)));
}
