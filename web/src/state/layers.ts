/** Which layers of the map are on. */

import { signal } from "@preact/signals";

export interface Switches {
  readonly tracks: boolean;
  readonly discs: boolean;
  readonly hulls: boolean;
  readonly names: boolean;
  readonly ghosts: boolean;
  readonly risk: boolean;
  readonly trails: boolean;
  readonly flight: boolean;
  readonly remarks: boolean;
}

export const switches = signal<Switches>({
  tracks: true,
  discs: true,
  hulls: true,
  names: true,
  ghosts: true,
  risk: true,
  trails: true,
  flight: true,
  remarks: true,
});

export function flip(layer: keyof Switches): void {
  switches.value = { ...switches.value, [layer]: !switches.value[layer] };
}
