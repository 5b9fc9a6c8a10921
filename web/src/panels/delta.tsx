/** The risk bound as a slider, with what plans cost along it. */

import { useMemo } from "preact/hooks";
import { Block, Button, NumberField } from "./controls";
import { bound, cost, counted, signedCost } from "./format";
import { atMost, estimated, priced, type PricePoint } from "./price";
import { useWidth } from "./width";

/** Ends of the slider, as powers of ten: a bound is below 0.5. */
const LOW = -6;
const HIGH = Math.log10(0.49);

/** Half the width of the slider's thumb [px]: its middle goes from one to the other end but for it. */
const INSET = 8;
const HEIGHT = 64;
const SAMPLES = 120;

export interface DeltaProps {
  /** Δ of the next search. */
  readonly riskBound: number;
  /** Δ in the scenario. */
  readonly ofScenario: number;
  readonly points: readonly PricePoint[];
  /** Plan that is shown, where it is one of the points. */
  readonly shown: string | null;
  readonly onChange: (riskBound: number) => void;
  readonly onShow: (plan: string) => void;
  /** Writes the bound into the scenario. */
  readonly onWrite: (riskBound: number) => void;
}

export function Delta(props: DeltaProps) {
  const { riskBound, ofScenario, points, onChange } = props;
  const [host, width] = useWidth();
  const isMoved = Math.abs(Math.log(riskBound / ofScenario)) > 1e-6;
  const here = priced(points, riskBound);
  return (
    <Block title="Risk bound Δ" aside={<span class="p-value">{bound(riskBound)}</span>}>
      <div class="p-delta" ref={host}>
        {points.length > 0 && width > 0 && <PriceCurve {...props} width={width} />}
        <input
          type="range"
          aria-label="Risk bound Δ, logarithmic"
          aria-valuetext={`${bound(riskBound)}${here === null ? "" : `, cost ${words(here.kind)} ${cost(here.cost)}`}`}
          min={LOW}
          max={HIGH}
          step={0.005}
          value={Math.log10(riskBound)}
          onInput={(event) => onChange(rounded(10 ** Number(event.currentTarget.value)))}
        />
        <Ticks />
      </div>
      <p class="p-note">{price(props)}</p>
      <div class="p-actions">
        <NumberField label="Δ" unit="%" value={Number((riskBound * 100).toPrecision(6))} min={1e-7} max={49.9} onChange={(value) => onChange((value ?? 1) / 100)} />
        {isMoved && <Button onClick={() => props.onWrite(riskBound)}>Set in scenario</Button>}
        {isMoved && (
          <Button kind="quiet" onClick={() => onChange(ofScenario)}>
            {`Back to ${bound(ofScenario)}`}
          </Button>
        )}
      </div>
    </Block>
  );
}

/** Two digits are enough for a bound that is dragged. */
function rounded(riskBound: number): number {
  return Math.min(Number(riskBound.toPrecision(2)), 0.49);
}

function words(kind: "found" | "estimated" | "at most"): string {
  return kind === "found" ? "found" : kind === "estimated" ? "about" : "at most";
}

function price({ points, riskBound, shown }: DeltaProps): string {
  const here = priced(points, riskBound);
  if (points.length === 0) return "Plans that hold show here what another Δ would cost.";
  if (here === null) return `No plan tells what ${bound(riskBound)} would cost.`;
  const from = points.find((point) => point.plan === shown);
  const change = from === undefined || from.riskBound === riskBound ? "" : `, ${signedCost(here.cost - from.cost)} against the plan shown`;
  const source = here.kind === "estimated" ? `, from ${counted(points.length, "plan")} and their shadow prices` : "";
  const sure = atMost(points, riskBound);
  const most = here.kind === "estimated" && sure !== null ? `; at most ${cost(sure)} for sure` : "";
  return `Cost at ${bound(riskBound)}: ${words(here.kind)} ${cost(here.cost)}${change}${source}${most}.`;
}

/** Place of a bound along the slider [px]. */
function place(riskBound: number, width: number): number {
  // What is certified may be less than any bound that the slider has.
  const share = Math.max((Math.log10(riskBound) - LOW) / (HIGH - LOW), 0);
  return INSET + share * (width - 2 * INSET);
}

function PriceCurve(props: DeltaProps & { width: number }) {
  const { points, width, riskBound, shown } = props;
  const drawn = useMemo(() => curveOf(points, width), [points, width]);
  const here = priced(points, riskBound);
  return (
    <div class="p-price">
      <svg width={width} height={HEIGHT} role="img" aria-label={`Cost over Δ through ${counted(points.length, "plan")}`}>
        <path class="p-sure" d={drawn.sure} />
        <path class="p-guess" d={drawn.guess} />
        {here !== null && (
          <path class="p-now" d={`M${place(riskBound, width)} ${HEIGHT}V${drawn.y(here.cost)}`} />
        )}
      </svg>
      {points.map((point) => (
        <button
          key={point.plan}
          type="button"
          class="p-dot"
          aria-pressed={point.plan === shown}
          aria-label={`Show the plan of cost ${cost(point.cost)} at Δ = ${bound(point.riskBound)}`}
          title={`${cost(point.cost)} at ${bound(point.riskBound)}`}
          style={{ left: `${place(point.riskBound, width)}px`, top: `${drawn.y(point.cost)}px` }}
          onClick={() => props.onShow(point.plan)}
        />
      ))}
      {drawn.most > drawn.least && (
        <>
          <span class="p-most">{`cost ${cost(drawn.most)}`}</span>
          <span class="p-least">{`cost ${cost(drawn.least)}`}</span>
        </>
      )}
    </div>
  );
}

/** The estimate, and the staircase of what is known for sure, as paths. */
function curveOf(points: readonly PricePoint[], width: number) {
  const samples = Array.from({ length: SAMPLES + 1 }, (_, i) => 10 ** (LOW + ((HIGH - LOW) * i) / SAMPLES));
  const guesses = samples.flatMap((x): [number, number][] => {
    const value = estimated(points, x);
    return value === null ? [] : [[x, value]];
  });
  const costs = [...points.map((point) => point.cost), ...guesses.map(([, value]) => value)];
  const least = Math.min(...costs);
  const most = Math.max(...costs);
  // A single cost stands in the middle.
  const y = (value: number) => HEIGHT - 6 - (most > least ? (value - least) / (most - least) : 0.5) * (HEIGHT - 14);
  const guess = guesses.map(([x, value], i) => `${i === 0 ? "M" : "L"}${place(x, width).toFixed(1)} ${y(value).toFixed(1)}`).join("");
  const stairs = [...points].sort((a, b) => a.certified - b.certified);
  const sure = stairs.map((point, i) => `${i === 0 ? "M" : "H"}${place(point.certified, width).toFixed(1)} ${i === 0 ? "" : "V"}${y(point.cost).toFixed(1)}`).join("");
  return { guess, sure: sure === "" ? "" : `${sure}H${width - INSET}`, y, least, most };
}

const DECADES = [-6, -4, -3, -2, -1] as const;

function Ticks() {
  return (
    <div class="p-ticks" aria-hidden="true">
      {DECADES.map((power) => (
        <span key={power} style={{ left: `calc(${INSET}px + (100% - ${2 * INSET}px) * ${(power - LOW) / (HIGH - LOW)})` }}>
          {bound(10 ** power)}
        </span>
      ))}
    </div>
  );
}
