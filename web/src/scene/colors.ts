/** Colors of the map, which are those of the page's theme. */

export interface Colors {
  readonly isDark: boolean;
  readonly ground: string;
  readonly grid: string;
  readonly gridStrong: string;
  readonly text: string;
  readonly muted: string;
  readonly obstacle: string;
  readonly obstacleEdge: string;
  readonly alert: string;
  readonly accent: string;
  /** Okabe and Ito without black and yellow, as in the library's pictures. */
  readonly palette: readonly string[];
}

export const LIGHT: Colors = {
  isDark: false,
  ground: "#FFFFFF",
  grid: "#EEF0F2",
  gridStrong: "#DDE1E5",
  text: "#15191E",
  muted: "#555B63",
  obstacle: "#D9DBDE",
  obstacleEdge: "#84888E",
  alert: "#C00000",
  accent: "#0B63A8",
  palette: ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"],
};

export const DARK: Colors = {
  isDark: true,
  ground: "#14171A",
  grid: "#1E2327",
  gridStrong: "#2A3036",
  text: "#E6E9EC",
  muted: "#9DA5AE",
  obstacle: "#343A41",
  obstacleEdge: "#7C858F",
  alert: "#FF6B5E",
  accent: "#5CB2F0",
  palette: ["#3E9BD8", "#F08544", "#2FBF96", "#DE97BD", "#F0B53C", "#86CBF2"],
};
