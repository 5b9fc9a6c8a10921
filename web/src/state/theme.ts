/** Light or dark: as the system says, unless the operator chose. */

import { computed, effect, signal } from "@preact/signals";

export type Choice = "system" | "light" | "dark";

const query = window.matchMedia("(prefers-color-scheme: dark)");
const isSystemDark = signal(query.matches);
query.addEventListener("change", (event) => (isSystemDark.value = event.matches));

const kept = localStorage.getItem("theme");

export const choice = signal<Choice>(kept === "light" || kept === "dark" ? kept : "system");

export const theme = computed<"light" | "dark">(() =>
  choice.value === "system" ? (isSystemDark.value ? "dark" : "light") : choice.value,
);

effect(() => {
  document.documentElement.dataset["theme"] = theme.value;
  if (choice.value === "system") localStorage.removeItem("theme");
  else localStorage.setItem("theme", choice.value);
});

export function flipTheme(): void {
  choice.value = theme.peek() === "dark" ? "light" : "dark";
}
