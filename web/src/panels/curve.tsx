/** Curves over time by uPlot, in the colors of the page. */

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";

/** One line of a curve: points in the order of x. */
export interface Line {
  readonly name: string;
  readonly points: readonly (readonly [x: number, y: number])[];
  /** A custom property of the page's theme, such as `--accent`. */
  readonly color: string;
  readonly look: "line" | "steps" | "dots" | "area";
  readonly dashed?: boolean;
}

/** Half of the widest number with its unit, below the end of the axis [px]. */
const HALF_NUMBER = 22;

interface CurveProps {
  /** What it shows, for who does not see it: one sentence with its numbers. */
  readonly label: string;
  readonly lines: readonly Line[];
  readonly height: number;
  readonly xUnit: string;
  readonly format: (value: number) => string;
  /** Least span of x, so that a search that begins is no point. */
  readonly xTo?: number;
  /** y begins at zero. */
  readonly fromZero?: boolean;
  /** A vertical line, such as the present. */
  readonly at?: number | null;
}

/** Height follows from `height`, width from the surroundings; built again when the theme changes. */
export function Curve(props: CurveProps) {
  const host = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const latest = useRef(props);
  latest.current = props;
  const looks = props.lines.map((line) => `${line.name} ${line.look}`).join("\n");
  useEffect(() => {
    const element = host.current;
    if (element === null) return undefined;
    const build = () => {
      plot.current?.destroy();
      plot.current = null;
      if (element.clientWidth === 0) return;
      plot.current = new uPlot(options(element, latest), data(latest.current.lines), element);
    };
    const sizes = new ResizeObserver(build);
    sizes.observe(element);
    const theme = new MutationObserver(build);
    theme.observe(document.documentElement, { attributeFilter: ["data-theme"] });
    const preferred = window.matchMedia("(prefers-color-scheme: dark)");
    preferred.addEventListener("change", build);
    return () => {
      sizes.disconnect();
      theme.disconnect();
      preferred.removeEventListener("change", build);
      plot.current?.destroy();
      plot.current = null;
    };
  }, [looks, props.height]);
  useEffect(() => plot.current?.setData(data(props.lines)), [props.lines]);
  // The present moves with every frame: only it is drawn again.
  useEffect(() => plot.current?.redraw(false), [props.at]);
  return <div class="p-curve" ref={host} role="img" aria-label={props.label} style={{ height: `${props.height}px` }} />;
}

/** One x for all lines: uPlot wants a common one; holes are `undefined`, which lines pass over. */
function data(lines: readonly Line[]): uPlot.AlignedData {
  const xs = [...new Set(lines.flatMap((line) => line.points.map(([x]) => x)))].sort((a, b) => a - b);
  const ys = lines.map((line) => {
    const values = new Map(line.points);
    return xs.map((x) => values.get(x));
  });
  return [xs, ...ys];
}

function options(element: HTMLElement, latest: { readonly current: CurveProps }): uPlot.Options {
  const props = latest.current;
  const color = (name: string) => colorOf(element, name);
  const axis = { stroke: color("--muted"), font: `11px ${getComputedStyle(element).fontFamily}`, ticks: { show: false } };
  const text = color("--text");
  const grid = { stroke: color("--line"), width: 1 };
  return {
    width: element.clientWidth,
    height: props.height,
    padding: [6, HALF_NUMBER, 0, 0],
    legend: { show: false },
    cursor: { show: false },
    scales: {
      x: { time: false, range: (_, low, high) => [Math.min(low, 0), Math.max(high, latest.current.xTo ?? 0, low + 1e-9)] },
      y: { range: (_, low, high) => yRange(low, high, props.fromZero === true) },
    },
    axes: [
      { ...axis, grid: { show: false }, size: 24, gap: 6, values: (_, ticks) => ticks.map((x, i) => withUnit(x, i === ticks.length - 1 ? props.xUnit : "")) },
      { ...axis, grid, size: 54, gap: 4, space: 24, values: (_, ticks) => ticks.map(props.format) },
    ],
    series: [{}, ...props.lines.map((line) => seriesOf(line, color(line.color)))],
    hooks: { draw: [(plot) => drawPresent(plot, latest.current.at ?? null, text)] },
  };
}

/** A color of the theme as `rgb(…)`: a custom property alone may still be a choice by theme. */
function colorOf(element: HTMLElement, name: string): string {
  const probe = document.createElement("span");
  probe.style.color = `var(${name})`;
  element.append(probe);
  const { color } = getComputedStyle(probe);
  probe.remove();
  return color;
}

function withUnit(value: number, unit: string): string {
  const digits = String(Number(value.toPrecision(6)));
  return unit === "" ? digits : `${digits} ${unit}`;
}

function yRange(low: number, high: number, fromZero: boolean): [number, number] {
  const bottom = fromZero ? 0 : low;
  const width = high - bottom;
  const room = width > 0 ? width * 0.08 : Math.max(Math.abs(high) * 0.01, 1e-9);
  return [fromZero ? 0 : bottom - room, high + room];
}

function seriesOf(line: Line, color: string): uPlot.Series {
  const isDots = line.look === "dots";
  return {
    label: line.name,
    stroke: color,
    width: isDots ? 0 : 1.5,
    spanGaps: true,
    points: { show: isDots, size: 6, fill: color, stroke: color },
    ...(line.look === "area" ? { fill: color.replace("rgb(", "rgba(").replace(")", ", 0.25)") } : {}),
    ...(line.look === "steps" || line.look === "area" ? { paths: stepped } : {}),
    ...(isDots ? { paths: () => null } : {}),
    ...(line.dashed === true ? { dash: [4, 3] } : {}),
  };
}

const stepped: uPlot.Series.PathBuilder = (...told) => uPlot.paths.stepped?.({ align: 1 })(...told) ?? null;

function drawPresent(plot: uPlot, at: number | null, color: string): void {
  if (at === null) return;
  const x = Math.round(plot.valToPos(at, "x", true)) + 0.5;
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.strokeStyle = color;
  ctx.lineWidth = 1;
  // The last curve may have been dashed.
  ctx.setLineDash([]);
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}

/** Names of the lines with their colors, below a curve. */
export function Key(props: { lines: readonly Line[] }) {
  return (
    <ul class="p-key" aria-hidden="true">
      {props.lines.map((line) => (
        <li key={line.name}>
          <svg width="16" height="8" viewBox="0 0 16 8">
            {line.look === "dots" ? (
              <circle cx="8" cy="4" r="3" style={{ fill: `var(${line.color})` }} />
            ) : (
              <path d="M0 4H16" style={{ stroke: `var(${line.color})`, strokeWidth: 1.5, strokeDasharray: line.dashed === true ? "4 3" : "none" }} />
            )}
          </svg>
          {line.name}
        </li>
      ))}
    </ul>
  );
}
