/** Colors of the map, which go with those of `style/theme.css`. */

export interface Colors {
  readonly isDark: boolean;
  readonly ground: string;
  readonly outside: string;
  readonly grid: string;
  readonly gridStrong: string;
  readonly text: string;
  readonly muted: string;
  readonly obstacle: string;
  readonly obstacleEdge: string;
  readonly alert: string;
  readonly warn: string;
  readonly accent: string;
  /** Okabe and Ito without black and yellow, as in the library's pictures. */
  readonly palette: readonly string[];
}

export const LIGHT: Colors = {
  isDark: false,
  ground: "#FFFFFF",
  outside: "#F3F4F6",
  grid: "#F0F2F4",
  gridStrong: "#E0E4E8",
  text: "#15191E",
  muted: "#5A6169",
  obstacle: "#D6D9DD",
  obstacleEdge: "#7D838A",
  alert: "#C00000",
  warn: "#8A5A00",
  accent: "#0B63A8",
  palette: ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#7B3FB0", "#73A800", "#D0129C"],
};

export const DARK: Colors = {
  isDark: true,
  ground: "#14171A",
  outside: "#0F1113",
  grid: "#1B1F23",
  gridStrong: "#282E33",
  text: "#E6E9EC",
  muted: "#9DA5AE",
  obstacle: "#343A41",
  obstacleEdge: "#838C96",
  alert: "#FF6B5E",
  warn: "#E0B45C",
  accent: "#5CB2F0",
  palette: ["#3E9BD8", "#F08544", "#2FBF96", "#DE97BD", "#F0B53C", "#A67BDD", "#A3CF45", "#EE62C6"],
};

/** Shares of white (> 0) or black (< 0), far apart so that vehicles of a set differ in gray, too. */
const SHADES = [0, -0.55, 0.42, -0.28, 0.2];
const SHADES_ON_DARK = [0, 0.6, -0.4, 0.3, -0.2];

type Sets = readonly (readonly string[])[];

const cache = new WeakMap<Sets, WeakMap<readonly string[], Map<Colors, readonly string[]>>>();

/** Color per vehicle: one hue per set of vehicles planned together, one shade for each in it. */
export function vehicleColors(
  names: readonly string[],
  sets: Sets,
  colors: Colors,
): readonly string[] {
  const ofSets = cache.get(sets) ?? new WeakMap<readonly string[], Map<Colors, readonly string[]>>();
  cache.set(sets, ofSets);
  const ofNames = ofSets.get(names) ?? new Map<Colors, readonly string[]>();
  ofSets.set(names, ofNames);
  const known = ofNames.get(colors);
  if (known !== undefined) return known;
  const listed = new Set(sets.flat());
  const groups = [...sets, ...names.filter((name) => !listed.has(name)).map((name) => [name])];
  const found = new Map<string, string>();
  const shades = colors.isDark ? SHADES_ON_DARK : SHADES;
  const places = placesOfHues(groups.map((group) => group.length > 1), colors.palette.length);
  groups.forEach((group, i) => {
    const [hue, turn] = places[i] ?? [0, 0];
    group.forEach((name, j) =>
      found.set(name, mixed(colors.palette[hue] ?? colors.accent, shades[(turn + j) % shades.length] ?? 0)),
    );
  });
  const result = names.map((name) => found.get(name) ?? colors.accent);
  ofNames.set(colors, result);
  return result;
}

/** Each set's hue, and how often hues were repeated before it: sets of several have their own, if possible. */
function placesOfHues(areSeveral: readonly boolean[], count: number): readonly (readonly [number, number])[] {
  const several = areSeveral.filter(Boolean).length;
  if (areSeveral.length <= count || several >= count) {
    return areSeveral.map((_, i) => [i % count, Math.floor(i / count)] as const);
  }
  const left = count - several;
  let [own, alone] = [0, 0];
  return areSeveral.map((isSeveral) => {
    if (isSeveral) return [own++, 0] as const;
    const k = alone++;
    return [several + (k % left), Math.floor(k / left)] as const;
  });
}

function mixed(color: string, amount: number): string {
  const target = amount > 0 ? 255 : 0;
  const parts = [1, 3, 5].map((at) => {
    const part = parseInt(color.slice(at, at + 2), 16);
    return Math.round(part + Math.abs(amount) * (target - part))
      .toString(16)
      .padStart(2, "0");
  });
  return `#${parts.join("")}`;
}
