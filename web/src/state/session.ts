/** What the server said at the start, and short notices to the operator. */

import { signal } from "@preact/signals";
import { CallError } from "../connection";
import type { Hello, Judging } from "../protocol";

export const hello = signal<Hello | null>(null);

/** What is shown until the server has said it. */
export const OPENING = "Opening …";

/** Why there is no document. */
export function whyEmpty(): string {
  return hello.value === null ? OPENING : "Nothing is open.";
}

/** One line that something went wrong, or was done; shown until the next one or a click. */
export interface Notice {
  readonly text: string;
  readonly isError: boolean;
}

export const notice = signal<Notice | null>(null);

/** What the referee is at before a file's plan is shown. */
export const judging = signal<Judging | null>(null);

/** Side panels. */
export type Tab = "plan" | "risk" | "flight" | "scene";

export const tab = signal<Tab>("scene");

export function tell(text: string): void {
  notice.value = { text, isError: false };
}

/** Tell what a call was refused for. */
export function complain(error: unknown): void {
  const text = error instanceof CallError || error instanceof Error ? error.message : String(error);
  notice.value = { text, isError: true };
}

export const helpIsOpen = signal(false);

/** Whether a scene in space is looked at from above, which is how it is edited. */
export const isFromAbove = signal(false);

/** On small screens, how much of it the panels take. */
export const sheet = signal<"low" | "half" | "tall">("half");
