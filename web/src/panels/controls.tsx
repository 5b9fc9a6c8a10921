/** Small parts that all panels are made of. */

import type { ComponentChildren } from "preact";
import { useId, useState } from "preact/hooks";

/** A part of a panel with a heading; `aside` stands at the end of the heading's line. */
export function Block(props: { title: string; aside?: ComponentChildren; children: ComponentChildren }) {
  const id = useId();
  return (
    <section class="p-block" aria-labelledby={id}>
      <div class="p-head">
        <h2 id={id}>{props.title}</h2>
        {props.aside}
      </div>
      {props.children}
    </section>
  );
}

/** What is heard between numbers that are seen in columns. */
export function Heard({ text }: { text: string }) {
  return <span class="p-heard">{text}</span>;
}

interface ButtonProps {
  readonly children: ComponentChildren;
  readonly onClick: () => void;
  readonly kind?: "main" | "plain" | "quiet";
  readonly disabled?: boolean;
  /** Name for who does not see the text's surroundings. */
  readonly label?: string;
  /** Of a button that is on or off. */
  readonly pressed?: boolean;
}

export function Button({ children, onClick, kind = "plain", disabled = false, label, pressed }: ButtonProps) {
  return (
    <button
      type="button"
      class={`p-button p-${kind}`}
      disabled={disabled}
      aria-label={label}
      aria-pressed={pressed}
      onClick={({ detail }) => {
        // The second click of a double click was not meant for what has come to be there since the first.
        if (detail < 2) onClick();
      }}
    >
      {children}
    </button>
  );
}

/** Names and numbers side by side. */
export function Facts(props: { rows: readonly (readonly [name: string, value: ComponentChildren, look?: "wide"])[] }) {
  return (
    <dl class="p-facts">
      {props.rows.map(([name, value, look]) => (
        <div key={name} class={look === "wide" ? "p-wide" : undefined}>
          <dt>{name}</dt>
          <dd>{value}</dd>
        </div>
      ))}
    </dl>
  );
}

interface NumberFieldProps {
  readonly label: string;
  readonly unit?: string;
  /** null shows an empty field, where `optional` allows it. */
  readonly value: number | null;
  readonly min: number;
  readonly max: number;
  readonly whole?: boolean;
  readonly optional?: boolean;
  readonly onChange: (value: number | null) => void;
}

/** A number with its unit beside; what is out of range is told below and not handed on. */
export function NumberField(props: NumberFieldProps) {
  const id = useId();
  const [draft, setDraft] = useState<string | null>(null);
  const shown = draft ?? (props.value === null ? "" : String(props.value));
  const wrong = draft === null ? null : wrongNumber(draft, props);
  const commit = () => {
    if (draft === null || wrongNumber(draft, props) !== null) return;
    const value = draft.trim() === "" ? null : Number(draft);
    setDraft(null);
    if (value !== props.value) props.onChange(value);
  };
  return (
    <div class="p-field">
      <label for={id}>{props.label}</label>
      <span class="p-input">
        <input
          id={id}
          inputMode={props.whole === true ? "numeric" : "decimal"}
          autocomplete="off"
          value={shown}
          aria-invalid={wrong !== null}
          aria-describedby={wrong === null ? undefined : `${id}-wrong`}
          onInput={(event) => setDraft(event.currentTarget.value)}
          onBlur={commit}
          onKeyDown={(event) => {
            if (event.key === "Enter") commit();
            if (event.key === "Escape") setDraft(null);
          }}
        />
        {props.unit !== undefined && <span class="p-unit">{props.unit}</span>}
      </span>
      {wrong !== null && (
        <span class="p-wrong" id={`${id}-wrong`}>
          {wrong}
        </span>
      )}
    </div>
  );
}

function wrongNumber(text: string, props: NumberFieldProps): string | null {
  if (text.trim() === "") return props.optional === true ? null : "a number is needed";
  const value = Number(text);
  if (!Number.isFinite(value)) return "not a number";
  if (props.whole === true && !Number.isInteger(value)) return "a whole number is needed";
  if (value < props.min || value > props.max) return `from ${props.min} to ${props.max}`;
  return null;
}

interface ChoiceProps {
  readonly label: string;
  readonly value: string;
  readonly options: readonly { readonly name: string; readonly text?: string }[];
  readonly onChange: (value: string) => void;
}

/** One of a list; what the chosen one is stands below. */
export function Choice({ label, value, options, onChange }: ChoiceProps) {
  const id = useId();
  const chosen = options.find((option) => option.name === value);
  return (
    <div class="p-field">
      <label for={id}>{label}</label>
      <select
        id={id}
        value={value}
        aria-describedby={chosen?.text === undefined ? undefined : `${id}-text`}
        onChange={(event) => onChange(event.currentTarget.value)}
      >
        {options.map((option) => (
          <option key={option.name} value={option.name}>
            {option.name}
          </option>
        ))}
      </select>
      {chosen?.text !== undefined && (
        <span class="p-note" id={`${id}-text`}>
          {chosen.text}
        </span>
      )}
    </div>
  );
}

/** A switch with its name beside. */
export function Toggle(props: { label: string; on: boolean; onChange: (on: boolean) => void }) {
  return (
    <label class="p-toggle">
      <input type="checkbox" checked={props.on} onChange={(event) => props.onChange(event.currentTarget.checked)} />
      {props.label}
    </label>
  );
}

/** What is said where there is nothing to show. */
export function Empty(props: { children: ComponentChildren }) {
  return <p class="p-empty">{props.children}</p>;
}
