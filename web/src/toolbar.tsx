/** The bar above the map: document, undo, tools, view. */

import { redo, undo } from "./actions";
import { pending } from "./connection";
import { after } from "./edit/nudge";
import { choose, tool, type Tool } from "./edit/tools";
import { dialog, save } from "./files/saving";
import { Icon, type IconName } from "./icons";
import { fit, zoom } from "./scene/viewport";
import { document } from "./state/document";
import { flip, switches, type Switches } from "./state/layers";
import { helpIsOpen } from "./state/session";
import { flipTheme, theme } from "./state/theme";

const TOOLS: readonly (readonly [Tool, string, string])[] = [
  ["select", "Select", "V"],
  ["vehicle", "Vehicle", "N"],
  ["waypoint", "Waypoint", "W"],
  ["polygon", "Polygon", "P"],
  ["box", "Box", "B"],
  ["line", "Line", "L"],
];

const LAYERS: readonly (readonly [keyof Switches, string])[] = [
  ["tracks", "Tracks"],
  ["hulls", "Hulls"],
  ["discs", "Discs at the level"],
  ["names", "Names"],
  ["ghosts", "Moving obstacles over time"],
  ["risk", "Risk"],
  ["trails", "Simulated missions"],
  ["flight", "Flight"],
  ["remarks", "Remarks"],
];

interface ButtonProps {
  readonly icon: IconName;
  readonly label: string;
  readonly keys?: string;
  readonly isOff?: boolean;
  readonly isPressed?: boolean;
  readonly act: () => void;
}

function IconButton({ icon, label, keys, isOff = false, isPressed, act }: ButtonProps) {
  return (
    <button
      type="button"
      class="icon-button"
      aria-label={label}
      {...(isPressed === undefined ? {} : { "aria-pressed": isPressed })}
      title={keys === undefined ? label : `${label} (${keys})`}
      disabled={isOff}
      onClick={act}
    >
      <Icon name={icon} />
    </button>
  );
}

export function Toolbar() {
  const state = document.value;
  return (
    <header class="toolbar">
      <h1 class="unseen">radmpc{state?.view == null ? "" : `: ${state.view.name}`}</h1>
      <div class="group file">
        <IconButton icon="open" label="Open or new" act={() => (dialog.value = "open")} />
        <IconButton icon="save" label="Save" keys="Ctrl+S" isOff={state === null} act={() => void save()} />
        <DocumentName />
      </div>
      <div class="group history">
        <IconButton icon="undo" label="Undo" keys="Ctrl+Z" isOff={state?.canUndo !== true} act={() => after(undo)} />
        <IconButton icon="redo" label="Redo" keys="Ctrl+Shift+Z" isOff={state?.canRedo !== true} act={() => after(redo)} />
      </div>
      <div class="group tools" role="group" aria-label="Tools">
        {TOOLS.map(([name, label, key]) => (
          <IconButton
            key={name}
            icon={name}
            label={label}
            keys={key}
            isOff={state === null}
            isPressed={tool.value === name}
            act={() => choose(name)}
          />
        ))}
      </div>
      <span class="spring" aria-hidden="true" />
      <div class="group">
        <span class="zoom">
          <IconButton icon="minus" label="Zoom out" keys="−" act={() => zoom(0.8)} />
          <IconButton icon="plus" label="Zoom in" keys="+" act={() => zoom(1.25)} />
        </span>
        <IconButton icon="fit" label="Show all" keys="F" act={fit} />
        <LayerMenu />
        <IconButton icon="theme" label={theme.value === "dark" ? "Light colors" : "Dark colors"} act={flipTheme} />
        <IconButton icon="help" label="Keys" keys="?" act={() => (helpIsOpen.value = true)} />
      </div>
    </header>
  );
}

function DocumentName() {
  const state = document.value;
  if (state === null) return <span class="document muted">no document</span>;
  const isBusy = pending.value > 0;
  return (
    <button type="button" class="document" title={state.file ?? "never saved"} onClick={() => (dialog.value = "save")}>
      <span class="name">{state.file ?? state.view?.name ?? "unnamed"}</span>
      {!state.isSaved && (
        <span class="changed" title="not saved">
          •<span class="unseen">, not saved</span>
        </span>
      )}
      {isBusy && <span class="busy muted" title="waiting for the server">…</span>}
    </button>
  );
}

function LayerMenu() {
  return (
    <details
      class="menu"
      onKeyDown={(event) => {
        if (event.key !== "Escape" || !event.currentTarget.open) return;
        event.currentTarget.open = false;
        event.currentTarget.querySelector("summary")?.focus();
        // It lets go of nothing else.
        event.preventDefault();
      }}
    >
      <summary class="icon-button" aria-label="Layers" title="Layers">
        <Icon name="layers" />
      </summary>
      <fieldset>
        <legend>Layers</legend>
        {LAYERS.map(([name, label]) => (
          <label key={name}>
            <input type="checkbox" checked={switches.value[name]} onChange={() => flip(name)} />
            {label}
          </label>
        ))}
      </fieldset>
    </details>
  );
}
