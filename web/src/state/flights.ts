/** Flights under way, and flights read from files. */

import { computed, signal } from "@preact/signals";
import type { FlightState } from "../protocol";
import { document } from "./document";

export const flights = computed<readonly FlightState[]>(() => document.value?.flights ?? []);

export const flightId = signal<string | null>(null);

export const flight = computed<FlightState | null>(
  () => flights.value.find((candidate) => candidate.flight === flightId.value) ?? null,
);
