import assert from "node:assert/strict";
import test from "node:test";
import { atMost, estimated, priced, pricePoints } from "../src/panels/price.ts";

const plan = (name, riskBound, cost, more = {}) => ({
  plan: name, revision: 1, planner: "certified", status: "optimal", riskBound, cost, bound: cost,
  certified: riskBound * 0.9, holds: true, seconds: 1, price: 0.15 / riskBound, explanation: null, ...more,
});
const POINTS = pricePoints([plan("a", 0.001, 18.8), plan("b", 0.01, 18.5), plan("c", 0.1, 18.1)], 1);

test("a plan that holds is on the curve at its own bound", () => {
  assert.deepEqual(priced(POINTS, 0.01), { cost: 18.5, kind: "found" });
});

test("the estimate never rises with the bound", () => {
  let before = Infinity;
  for (let power = -4; power <= -0.31; power += 0.01) {
    const now = estimated(POINTS, 10 ** power) ?? before;
    assert.ok(now <= before + 1e-12, `at ${10 ** power}`);
    before = now;
  }
});

test("steep prices do not make the estimate rise between plans", () => {
  const steep = pricePoints([plan("a", 0.001, 18.8, { price: 1e6 }), plan("b", 0.1, 18.7, { price: 0 })], 1);
  let before = Infinity;
  for (let power = -3; power <= -1; power += 0.01) {
    const now = estimated(steep, 10 ** power);
    assert.ok(now <= before + 1e-12);
    before = now;
  }
});

test("beside the plans the shadow price is the slope", () => {
  assert.ok(Math.abs(estimated(POINTS, 0.001 / Math.E) - (18.8 + 0.15)) < 1e-9);
  assert.ok(Math.abs(estimated(POINTS, 0.1 * Math.E) - (18.1 - 0.15)) < 1e-9);
});

test("far beyond all plans nothing is estimated", () => {
  assert.equal(estimated(POINTS, 0.001 / 20), null);
  assert.equal(priced(POINTS, 0.001 / 20), null);
});

test("without a price only what is sure is told", () => {
  const lone = pricePoints([plan("a", 0.01, 18.5, { price: null })], 1);
  assert.deepEqual(priced(lone, 0.05), { cost: 18.5, kind: "at most" });
  assert.equal(priced(lone, 0.005), null);
});

test("a plan serves every bound from its certificate on", () => {
  assert.equal(atMost(POINTS, 0.00901), 18.5);
  assert.equal(atMost(POINTS, 0.0089), 18.8);
  assert.equal(atMost(POINTS, 0.0001), null);
});

test("an estimate is never above what is sure", () => {
  for (let power = -3; power <= -0.5; power += 0.05) {
    const sure = atMost(POINTS, 10 ** power);
    const told = priced(POINTS, 10 ** power);
    if (sure !== null && told !== null) assert.ok(told.cost <= sure + 1e-12);
  }
});

test("plans that do not hold, of other revisions, or beaten are left out", () => {
  const points = pricePoints(
    [
      plan("good", 0.01, 18.5), plan("worse", 0.01, 18.9), plan("dearer", 0.02, 18.7),
      plan("over", 0.005, 17, { holds: false }), plan("old", 0.005, 17, { revision: 0 }),
      plan("none", 0.005, null, { certified: null }),
    ],
    1,
  );
  assert.deepEqual(points.map((point) => point.plan), ["good"]);
});
