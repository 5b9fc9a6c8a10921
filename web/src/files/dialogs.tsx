/** Dialogs: open a file or a template, save under a name, keys. */

import { useSignal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { call } from "../connection";
import { KEYS } from "../edit/keyboard";
import type { FileEntry } from "../protocol";
import { document } from "../state/document";
import { complain, hello, helpIsOpen, notice } from "../state/session";
import { JudgingLine } from "./judging";
import { NoticeLine } from "./notice";
import { dialog, openPath, openTemplate, saveAs, switchTo, take, unsaved } from "./saving";

export function Dialogs() {
  return (
    <>
      {dialog.value === "open" && <OpenDialog />}
      {dialog.value === "save" && <SaveDialog />}
      {helpIsOpen.value && <HelpDialog />}
    </>
  );
}

interface ModalProps {
  readonly title: string;
  readonly close: () => void;
  readonly children: ComponentChildren;
}

function Modal({ title, close, children }: ModalProps) {
  const element = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    const before = window.document.activeElement;
    element.current?.showModal();
    // One that is taken away without being closed leaves the focus nowhere.
    return () => {
      if (before instanceof HTMLElement) before.focus({ preventScroll: true });
    };
  }, []);
  return (
    <dialog ref={element} class="modal" aria-labelledby="modal-title" onClose={close}>
      <header>
        <h2 id="modal-title">{title}</h2>
        <button type="button" class="plain" aria-label="Close" onClick={() => element.current?.close()}>
          ×
        </button>
      </header>
      {children}
    </dialog>
  );
}

function OpenDialog() {
  const files = useSignal<readonly FileEntry[]>([]);
  const filter = useSignal("");
  useEffect(() => {
    notice.value = null;
    call("files", {}).then((found) => (files.value = found), complain);
    call("hello", {}).then((now) => (hello.value = now), complain);
  }, []);
  const known = hello.value;
  const wanted = filter.value.toLowerCase();
  const matching = files.value.filter((file) => file.path.toLowerCase().includes(wanted));
  return (
    <Modal title="Open" close={() => (dialog.value = null)}>
      <NoticeLine />
      <JudgingLine />
      <section>
        <h3>New</h3>
        <div class="choices">
          <button type="button" onClick={() => void openTemplate(null)}>
            Empty scenario
          </button>
          {known?.templates.map((template) => (
            <button key={template.name} type="button" title={template.text} onClick={() => void openTemplate(template.name)}>
              {template.name}
            </button>
          ))}
        </div>
      </section>
      {known !== null && known.documents.length > 1 && <OpenDocuments />}
      <section>
        <h3>
          Files in <code>{known?.folder ?? ""}</code>
        </h3>
        <input
          type="search"
          aria-label="Filter files"
          placeholder="Filter"
          value={filter.value}
          onInput={(event) => (filter.value = event.currentTarget.value)}
        />
        <ul class="files">
          {matching.map((file) => (
            <li key={file.path}>
              <button type="button" onClick={() => void openPath(file.path)}>
                <span>{file.path}</span>
                <span class="muted">{file.kind}</span>
                <span class="muted number">{sizeText(file.bytes)}</span>
              </button>
            </li>
          ))}
          {matching.length === 0 && <li class="empty">No file.</li>}
        </ul>
        <p class="muted">
          Scenarios, plans, flights and charts (GeoJSON, KML) can also be dropped on the page, or{" "}
          <label class="link">
            chosen from elsewhere
            <input
              type="file"
              class="unseen"
              multiple
              accept=".yaml,.yml,.json,.jsonl,.geojson,.kml"
              onChange={(event) => void take([...(event.currentTarget.files ?? [])])}
            />
          </label>
          .
        </p>
      </section>
    </Modal>
  );
}

function OpenDocuments() {
  return (
    <section>
      <h3>Open on this server</h3>
      <div class="choices">
        {hello.value?.documents.map((each) => (
          <button
            key={each.document}
            type="button"
            aria-current={each.document === document.value?.document}
            onClick={() => void switchTo(each.document)}
          >
            {each.name}
          </button>
        ))}
      </div>
    </section>
  );
}

function SaveDialog() {
  const state = document.value;
  const path = useSignal(state?.file ?? `${state?.view?.name ?? "scenario"}.yaml`);
  const problem = unsaved.value;
  const submit = async (overwrite: boolean) => {
    if (await saveAs(path.value, overwrite)) dialog.value = null;
  };
  const close = () => {
    dialog.value = null;
    unsaved.value = null;
  };
  return (
    <Modal title="Save as" close={close}>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          void submit(false);
        }}
      >
        <label class="stacked">
          Name in <code>{hello.value?.folder ?? ""}</code>
          <input
            autofocus
            value={path.value}
            aria-invalid={problem !== null}
            onInput={(event) => {
              path.value = event.currentTarget.value;
              unsaved.value = null;
            }}
          />
        </label>
        {problem !== null && (
          <p class="remark error" role="alert">
            {problem.text}
          </p>
        )}
        <div class="buttons">
          {problem?.isThere === true && (
            <button type="button" onClick={() => void submit(true)}>
              Overwrite
            </button>
          )}
          <button type="submit" class="primary">
            Save
          </button>
        </div>
      </form>
    </Modal>
  );
}

function HelpDialog() {
  return (
    <Modal title="Keys" close={() => (helpIsOpen.value = false)}>
      <table class="keys">
        <tbody>
          {KEYS.map(([key, text]) => (
            <tr key={key}>
              <th scope="row">
                <kbd>{key}</kbd>
              </th>
              <td>{text}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <p class="muted">radmpc {hello.value?.version ?? ""}</p>
    </Modal>
  );
}

function sizeText(bytes: number): string {
  if (bytes < 1000) return `${bytes} B`;
  return bytes < 1e6 ? `${(bytes / 1000).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
