import assert from "node:assert/strict";
import test from "node:test";
import { accountLines, replans, tickAt } from "../src/panels/account.ts";
import { differences } from "../src/panels/difference.ts";
import { Button } from "../src/panels/controls.tsx";
import { bound, cost, duration, leftOf, ofPercent, percent, percentUp, share, signedCost, signedPercent } from "../src/panels/format.ts";
import { sentence } from "../src/panels/search.tsx";
import { judged } from "../src/panels/simulate.tsx";
import { timeAfter } from "../src/panels/timeline.tsx";
import { around, Taken } from "../src/scene/placing.ts";
import { markAt, marksOf } from "../src/scene/layers/risk.ts";

test("a certified risk is never shown below itself", () => {
  assert.equal(percentUp(0.00998301), "0.999 %");
  assert.equal(percentUp(0.0500001), "5.01 %");
  assert.equal(percentUp(0.05), "5.00 %");
  assert.equal(percentUp(3.78e-8), "4·10⁻⁶ %");
  assert.equal(percentUp(9.7e-9), "1·10⁻⁶ %");
});

test("numbers are short, and nothing is a dash", () => {
  assert.equal(percent(0.00978), "0.978 %");
  assert.equal(percent(1e-12), "1·10⁻¹⁰ %");
  assert.equal(percent(null), "–");
  assert.equal(bound(0.05), "5 %");
  assert.equal(bound(0.000001), "0.0001 %");
  assert.equal(cost(18.47837), "18.478");
  assert.equal(share(0.004), "< 1 %");
  assert.equal(share(0), "0 %");
});

test("what is left of a bound is more than it by bad news alone, never by rounding", () => {
  assert.equal(leftOf(0.01237, 0.01237), "1.237 %");
  assert.equal(leftOf(0.01237, 0.0123699), "1.23 %");
  assert.equal(leftOf(0.05, 0.05001), "5.01 %");
});

test("changes carry their sign", () => {
  assert.equal(signedCost(-0.5), "−0.500");
  assert.equal(signedCost(0.25), "+0.250");
  assert.equal(signedPercent(0), "±0 %");
});

const tick = (step, isReplan = false) => ({
  step, states: [], left: 0.05 - 0.001 * step, spent: 0.001 * step, decision: "kept", isReplan, milliseconds: 5, alarm: null,
});
const FLIGHT = {
  flight: "f1", document: "d1", plan: "p1", state: "running", step: 4, steps: 8, riskBound: 0.05,
  ticks: [tick(0), tick(2, true), tick(4)], note: null,
};

test("a time shows the last tick before it", () => {
  assert.equal(tickAt(FLIGHT, 0).step, 0);
  assert.equal(tickAt(FLIGHT, 3.9).step, 2);
  assert.equal(tickAt(FLIGHT, 4).step, 4);
  assert.equal(tickAt(FLIGHT, 99).step, 4);
  assert.equal(tickAt({ ...FLIGHT, ticks: [] }, 1), null);
});

test("replans are marked on the account", () => {
  assert.deepEqual(replans(FLIGHT), [2]);
  const marks = accountLines(FLIGHT, 0.5).find((line) => line.look === "dots");
  assert.deepEqual(marks.points, [[1, 0.048]]);
});

const view = (dt, paths, perStep = 1) => ({
  perStep, scenario: { dt },
  tracks: paths.map((path, i) => ({ name: `v${i}`, path, ellipses: [], speed: [] })),
});

test("plans differ where they are farthest apart at the same second", () => {
  const one = view(1, [[[0, 0], [1, 0], [2, 0]], [[0, 5], [0, 5], [0, 5]]]);
  const other = view(2, [[[0, 0], [2, 3]], [[0, 5], [0, 5]]]);
  const [first, second] = differences(one, other);
  assert.equal(first.name, "v0");
  assert.equal(first.distance, 3);
  assert.equal(first.time, 2);
  assert.equal(second.distance, 0);
});

test("a vehicle of one plan alone is not compared", () => {
  assert.deepEqual(differences(view(1, [[[0, 0]]]), { ...view(1, []), tracks: [] }), []);
});

test("arrows go from step to step, with Shift by tenths, and never beyond", () => {
  assert.equal(timeAfter("ArrowRight", false, 4.6, 12), 5);
  assert.equal(timeAfter("ArrowLeft", false, 4.6, 12), 4);
  assert.equal(timeAfter("ArrowLeft", false, 4, 12), 3);
  assert.ok(Math.abs(timeAfter("ArrowRight", true, 4.6, 12) - 4.7) < 1e-9);
  assert.equal(timeAfter("ArrowRight", false, 12, 12), 12);
  assert.equal(timeAfter("Home", false, 4.6, 12), 0);
  assert.equal(timeAfter("End", false, 4.6, 12), 12);
  assert.equal(timeAfter("a", false, 4.6, 12), null);
});

test("what is spoken of a search does not change with the clock", () => {
  const search = { state: "running", found: 2, cost: 18.5, note: null, seconds: 1 };
  assert.equal(sentence(search), sentence({ ...search, seconds: 2 }));
  assert.match(sentence({ ...search, state: "failed", note: "the worker died" }), /the worker died/u);
});

test("an interval is judged against the certificate", () => {
  const trails = (low, high) => ({ interval: [low, high] });
  const plan = { certified: 0.05 };
  assert.match(judged(trails(0.03, 0.04), plan), /within/u);
  assert.match(judged(trails(0.04, 0.06), plan), /does not contradict/u);
  assert.match(judged(trails(0.06, 0.07), plan), /is contradicted/u);
});

test("a risk is found under the pointer, and what is next to nothing is not drawn", () => {
  const line = (risk, x) => ({ cause: "pair", vehicle: "a", other: "b", step: 1, risk, at: [x, 0] });
  const plan = { summary: { riskBound: 0.01 }, ledger: [line(0.005, 1), line(1e-9, 3)] };
  const camera = { px: (x) => 100 * x, py: (y) => -100 * y };
  assert.equal(marksOf(plan).length, 1);
  assert.equal(markAt(plan, camera, 105, 3).line.risk, 0.005);
  assert.equal(markAt(plan, camera, 300, 0), null);
});

test("what takes seconds is not told in thousands of milliseconds", () => {
  assert.equal(duration(7.83), "7.83 ms");
  assert.equal(duration(999.4), "999 ms");
  assert.equal(duration(999.9), "1 s");
  assert.equal(duration(15152.4), "15.2 s");
});

test("a name goes where no other stands, and is left out where there is no such place", () => {
  const taken = new Taken();
  const places = around(100, 50, 10, 30, 12);
  const first = taken.claim(places);
  assert.deepEqual(first, { left: 114, top: 44, width: 30, height: 12 });
  assert.equal(taken.claim(places), places[1]);
  taken.add({ left: 0, top: 0, width: 200, height: 100 });
  assert.equal(taken.claim(places), null);
});

test("the second click of a double click leaves alone what has come to be there since the first", () => {
  let clicks = 0;
  const { onClick } = Button({ children: "Plan", onClick: () => (clicks += 1) }).props;
  for (const detail of [1, 2, 3]) onClick({ detail });
  assert.equal(clicks, 1);
  // As by Enter.
  onClick({ detail: 0 });
  assert.equal(clicks, 2);
});

test("the least gap that can be entered is one that the server takes", () => {
  assert.equal(ofPercent(1e-7), 1e-9);
  assert.equal(ofPercent(0.7), 0.007);
});
