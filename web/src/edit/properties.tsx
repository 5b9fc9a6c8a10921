/** Numbers of the selected thing, with units, and under each what is wrong with it. */

import { useSignal } from "@preact/signals";
import { change } from "../actions";
import type { Document, Json, Remark } from "../protocol";
import { document, remarks } from "../state/document";
import { drawn } from "../state/playback";
import { selected, type Thing, turnOf } from "../state/selection";
import { remove } from "./create";
import { fieldsOf, type Cell, type Row } from "./fields";
import { get, startsWith } from "./paths";
import { RemarkLine } from "./remarks";
import { exists, nameOf, remarksOn } from "./things";

export function Properties() {
  const state = document.value;
  const scenario = drawn.value;
  if (state === null) return null;
  const thing = selected.value !== null && scenario !== null && exists(scenario, selected.value) ? selected.value : null;
  const groups = fieldsOf(state.content, thing);
  const rows = groups.flatMap((group) => group.rows);
  const rest =
    thing === null
      ? []
      : remarksOn(remarks.value, thing.path).filter((remark) => !rows.some((row) => startsWith(remark.path, row.path)));
  const isRemovable = thing !== null && thing.kind !== "goal";
  return (
    <section class="properties" aria-label="Properties">
      <header class="section">
        <h2>{thing === null || scenario === null ? "Scenario" : nameOf(scenario, thing)}</h2>
        {isRemovable && (
          <button type="button" class="plain" onClick={() => void remove(thing)}>
            Remove
          </button>
        )}
      </header>
      {rest.map((remark, i) => (
        <RemarkLine key={i} remark={remark} />
      ))}
      {groups.map((group, i) => (
        <fieldset key={group.title}>
          <legend class={i > 0 ? "" : "unseen"}>{group.title}</legend>
          {group.rows.map((row) => (
            <FieldRow key={keyOf(row, thing)} row={row} content={state.content} />
          ))}
        </fieldset>
      ))}
    </section>
  );
}

/** The same for a field however the place of its thing changes: what is typed into it stays in it. */
function keyOf(row: Row, thing: Thing | null): string {
  const own = row.path.slice(thing?.path.length ?? 0).join(".");
  return `${thing === null ? 0 : turnOf(thing)} ${own} ${row.label}`;
}

function FieldRow({ row, content }: { row: Row; content: Document }) {
  const wrong = remarksOn(remarks.value, row.path);
  const id = `field-${row.path.join("-")}`;
  return (
    <div class="field">
      <span class="label">{row.label}</span>
      <span class="cells">
        {row.cells.map((cell) => (
          <Input
            key={cell.path.slice(row.path.length).join(".")}
            cell={cell}
            row={row}
            content={content}
            isWrong={wrong.length > 0}
            describedBy={wrong.length > 0 ? id : undefined}
          />
        ))}
        <span class="unit">{row.unit}</span>
      </span>
      {wrong.length > 0 && <Wrong id={id} remarks={wrong} />}
    </div>
  );
}

function Wrong({ id, remarks: wrong }: { id: string; remarks: readonly Remark[] }) {
  return (
    <div class="wrong" id={id}>
      {wrong.map((remark, i) => (
        <RemarkLine key={i} remark={remark} />
      ))}
    </div>
  );
}

interface InputProps {
  readonly cell: Cell;
  readonly row: Row;
  readonly content: Document;
  readonly isWrong: boolean;
  readonly describedBy: string | undefined;
}

function Input({ cell, row, content, isWrong, describedBy }: InputProps) {
  const now = get(content, cell.path);
  const misread = useSignal<string | null>(null);
  // What is being typed: the field is drawn anew whenever anything in the document changes.
  const typed = useSignal<string | null>(null);
  const label = [row.label, cell.label, row.unit === "" ? "" : `in ${row.unit}`].filter(Boolean).join(" ");
  const clear = () => {
    typed.value = null;
    misread.value = null;
  };
  const set = (text: string) => {
    const read = parse(text, cell, row);
    misread.value = read.problem;
    if (read.problem !== null) return;
    if (same(read.value, now)) {
      clear();
      return;
    }
    const made = read.value === undefined ? { path: cell.path } : { path: cell.path, value: read.value };
    void change([made], `Set ${row.label.toLowerCase()}`).then(() => {
      if (typed.peek() === text) clear();
    });
  };
  if (cell.kind === "choice") {
    return (
      <select
        aria-label={label}
        value={typeof now === "string" ? now : textOf(row.otherwise)}
        onChange={(event) => set(event.currentTarget.value)}
      >
        {cell.choices?.map((choice) => <option key={choice}>{choice}</option>)}
      </select>
    );
  }
  return (
    <label class={`input ${cell.kind}`}>
      {cell.label !== "" && <span aria-hidden="true">{cell.label}</span>}
      <input
        aria-label={label}
        aria-invalid={isWrong || misread.value !== null}
        aria-describedby={describedBy}
        title={misread.value ?? ""}
        inputMode={cell.kind === "number" ? "decimal" : "text"}
        spellcheck={false}
        value={typed.value ?? textOf(now)}
        placeholder={row.otherwise === undefined ? "" : textOf(row.otherwise)}
        onInput={({ currentTarget: { value } }) => (typed.value = value === textOf(now) ? null : value)}
        onChange={(event) => set(event.currentTarget.value)}
        onKeyDown={(event) => {
          if (event.key === "Escape") clear();
        }}
      />
    </label>
  );
}

function parse(text: string, cell: Cell, row: Row): { value: Json | undefined; problem: string | null } {
  const trimmed = text.trim();
  if (cell.kind === "text" || cell.kind === "choice") return { value: trimmed, problem: null };
  if (trimmed === "") {
    return row.isOptional ? { value: undefined, problem: null } : { value: undefined, problem: "must be stated" };
  }
  try {
    const decimal = /^[-+]?\d+,\d+$/.test(trimmed) ? trimmed.replace(",", ".") : trimmed;
    return { value: JSON.parse(decimal.replace(/^\+/, "").replace(/^(-?)\./, "$10.")) as Json, problem: null };
  } catch {
    return { value: undefined, problem: cell.kind === "number" ? `must be a number, got '${trimmed}'` : "cannot be read" };
  }
}

function same(one: Json | undefined, other: Json | undefined): boolean {
  return JSON.stringify(one) === JSON.stringify(other);
}

function textOf(value: Json | undefined): string {
  if (value === undefined) return "";
  return typeof value === "string" ? value : JSON.stringify(value).replaceAll(",", ", ").replaceAll(":", ": ");
}
