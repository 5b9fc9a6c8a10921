/** Numbers as the panels show them: few digits, the same everywhere, risks never below the truth. */

/** What stands where there is no number. */
export const NOTHING = "–";

/** A number in plain digits with so many significant ones; `up` never rounds below its value. */
function plain(value: number, digits: number, rounding: (x: number) => number = Math.round): string {
  if (value === 0) return "0";
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(value))));
  const scale = 10 ** Math.min(decimals, 15);
  // What differs by rounding errors alone is the number itself.
  const scaled = Number((value * scale).toPrecision(12));
  return (rounding(scaled) / scale).toFixed(Math.min(decimals, 15));
}

/** A probability in percent, rounded to the nearest: `0.978 %`. */
export function percent(probability: number | null, digits = 3): string {
  return inPercent(probability, digits, Math.round);
}

/** A probability in percent that is an upper bound: rounded up. */
export function percentUp(probability: number | null, digits = 3): string {
  return inPercent(probability, digits, Math.ceil);
}

/** What is left of a risk bound: never more than it for rounding alone. */
export function leftOf(riskBound: number, left: number): string {
  return left === riskBound ? bound(riskBound) : inPercent(left, 3, left < riskBound ? Math.floor : Math.ceil);
}

function inPercent(probability: number | null, digits: number, rounding: (x: number) => number): string {
  if (probability === null || !Number.isFinite(probability)) return NOTHING;
  if (probability === 0) return "0 %";
  if (Math.abs(probability) < 1e-6) return powerOfTen(probability * 100, rounding);
  return `${plain(probability * 100, digits, rounding)} %`;
}

/** The share that so many percent are, without the noise of the last binary digits: 1e-7 % are 1e-9, and no less. */
export function ofPercent(percents: number): number {
  return Number((percents / 100).toPrecision(12));
}

/** Few digits and a power of ten: `4·10⁻⁶ %` stands in a column of a few digits. */
function powerOfTen(percents: number, rounding: (x: number) => number, digits = 1): string {
  let exponent = Math.floor(Math.log10(Math.abs(percents)));
  const scale = 10 ** (digits - 1);
  let factor = rounding(Number(((percents / 10 ** exponent) * scale).toPrecision(12))) / scale;
  if (Math.abs(factor) === 10) [factor, exponent] = [factor / 10, exponent + 1];
  const raised = Array.from(String(exponent), (sign) => (sign === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(sign)])).join("");
  return `${String(factor)}·10${raised} %`.replace("-", "−");
}

/** A risk bound, which people chose, without zeros at its end: `0.5 %`. */
export function bound(probability: number): string {
  if (probability > 0 && probability < 1e-6) return powerOfTen(probability * 100, Math.round, 4);
  return `${trimmed(probability * 100, 4)} %`;
}

/** A number without zeros at its end, as curves have it beside them. */
export function trimmed(value: number, digits = 5): string {
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}

/** A share of something in whole percent: `21 %`, and `< 1 %` rather than `0 %`. */
export function share(part: number): string {
  if (part > 0 && part < 0.01) return "< 1 %";
  return `${Math.round(part * 100)} %`;
}

/** A cost: five significant digits. */
export function cost(value: number | null): string {
  return value === null || !Number.isFinite(value) ? NOTHING : plain(value, 5);
}

/** A change of cost with its sign. */
export function signedCost(value: number): string {
  return signed(plain(Math.abs(value), 3), value);
}

/** A change of a probability with its sign, in percent points. */
export function signedPercent(value: number): string {
  return signed(percent(Math.abs(value)), value);
}

function signed(text: string, value: number): string {
  if (/^[0.]+( %)?$/u.test(text)) return `±${text}`;
  return value < 0 ? `−${text}` : `+${text}`;
}

/** A relative gap: percent with two digits. */
export function gap(value: number | null): string {
  // Costs that near to one another differ by rounding alone.
  return value === null ? NOTHING : percent(value > 1e-9 ? value : 0, 2);
}

/** Seconds: tenths below a minute, then minutes and seconds. */
export function seconds(value: number): string {
  if (value < 60) return `${value.toFixed(1)} s`;
  const whole = Math.round(value);
  return `${Math.floor(whole / 60)} min ${String(whole % 60).padStart(2, "0")} s`;
}

/** A time of milliseconds, or of seconds from one on: three digits. */
export function duration(milliseconds: number): string {
  const isLong = milliseconds >= 999.5;
  const digits = isLong ? milliseconds / 1000 : milliseconds;
  return `${Number(digits.toPrecision(3))} ${isLong ? "s" : "ms"}`;
}

/** Meters: centimeters are the last digit. */
export function meters(value: number): string {
  return `${value.toFixed(2)} m`;
}

/** A count with thin spaces between thousands. */
export function count(value: number): string {
  return String(value).replace(/\B(?=(\d{3})+(?!\d))/gu, "\u202f");
}

/** `1 plan`, `2 plans`. */
export function counted(value: number, noun: string): string {
  return `${count(value)} ${noun}${value === 1 ? "" : "s"}`;
}
