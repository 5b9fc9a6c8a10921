/** The view of values in notebooks: a module as anywidget loads it, with nothing beside it. */

import { signal } from "@preact/signals";
import { render } from "preact";
import { NotebookView } from "./notebook/view";
import type { PlanView, ScenarioView } from "./protocol";

interface Content {
  readonly scenario: ScenarioView;
  readonly plan: PlanView | null;
}

/** What anywidget hands over, as far as it is used. */
interface Model {
  get(key: "content"): Content;
  get(key: "time"): number;
  get(key: "_style"): string;
  set(key: "time", value: number): void;
  save_changes(): void;
  send(content: { readonly ask: "space" }): void;
  on(event: string, listener: Listener): void;
  off(event: string, listener: Listener): void;
}

type Listener = (content?: unknown, buffers?: readonly DataView[]) => void;

/** Notebooks say it in their own ways; elsewhere the system does. */
function isDarkNow(): boolean {
  const { body } = document;
  const jupyter = body.dataset["jpThemeLight"];
  if (jupyter !== undefined) return jupyter === "false";
  if (body.classList.contains("vscode-dark") || body.classList.contains("vscode-light")) {
    return body.classList.contains("vscode-dark");
  }
  return window.matchMedia("(prefers-color-scheme: dark)").matches;
}

/** The code for scenes in space, which the kernel sends when it is asked. */
function loadSpace(model: Model): Promise<typeof import("./space/space")> {
  return new Promise((resolve, reject) => {
    const hear: Listener = (content, buffers) => {
      const [code] = buffers ?? [];
      if ((content as { answer?: string } | undefined)?.answer !== "space" || code === undefined) return;
      model.off("msg:custom", hear);
      const bytes = new Uint8Array(code.buffer as ArrayBuffer, code.byteOffset, code.byteLength);
      const address = URL.createObjectURL(new Blob([bytes], { type: "text/javascript" }));
      const loaded = import(/* @vite-ignore */ address) as Promise<typeof import("./space/space")>;
      loaded.then(resolve, reject).finally(() => URL.revokeObjectURL(address));
    };
    model.on("msg:custom", hear);
    model.send({ ask: "space" });
  });
}

/** Where a view is put: apart from the notebook, whose styles and keys are for texts and cells. */
function placeIn(el: HTMLElement, style: string): { readonly host: HTMLElement; readonly root: ShadowRoot } {
  const host = document.createElement("div");
  host.dataset["lmSuppressShortcuts"] = "true"; // the front ends of Jupyter ask for it
  el.append(host);
  const root = host.attachShadow({ mode: "open" });
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(style);
  root.adoptedStyleSheets = [sheet];
  return { host, root };
}

function show({ model, el }: { readonly model: Model; readonly el: HTMLElement }): () => void {
  const time = signal(model.get("time"));
  const content = signal(model.get("content"));
  const isDark = signal(isDarkNow());
  const hear = () => {
    time.value = model.get("time");
    content.value = model.get("content");
  };
  let saving = 0;
  const setTime = (value: number) => {
    time.value = value;
    model.set("time", value);
    // The kernel need not know of every frame.
    clearTimeout(saving);
    saving = window.setTimeout(() => model.save_changes(), 150);
  };
  const View = () => (
    <NotebookView
      {...content.value}
      time={time.value}
      isDark={isDark.value}
      onTime={setTime}
      loadSpace={() => loadSpace(model)}
    />
  );
  model.on("change:time", hear);
  model.on("change:content", hear);
  const watch = new MutationObserver(() => (isDark.value = isDarkNow()));
  watch.observe(document.body, { attributes: true });
  const { host, root } = placeIn(el, model.get("_style"));
  render(<View />, root);
  return () => {
    watch.disconnect();
    clearTimeout(saving);
    model.off("change:time", hear);
    model.off("change:content", hear);
    render(null, root);
    host.remove();
  };
}

export default { render: show };
