import assert from "node:assert/strict";
import test from "node:test";
import { between, grouped, risksBySteps, sum } from "../src/panels/ledger.ts";

const line = (cause, vehicle, other, step, risk) => ({ cause, vehicle, other, step, risk, at: [0, 0] });
const LEDGER = [
  line("pair", "tug", "barge", 6, 0.002),
  line("pair", "tug", "barge", 7, 0.003),
  line("obstacle", "pilot", "tug", 6, 0.004),
  line("workspace", "tug", null, 12, 1e-9),
];

test("lines of one hazard are added up, the riskiest step first", () => {
  const [group] = grouped(LEDGER, null);
  assert.equal(group.hazards.length, 1);
  assert.equal(group.hazards[0].risk, 0.005);
  assert.deepEqual(group.hazards[0].lines.map((one) => one.step), [7, 6]);
});

test("groups sum to the ledger", () => {
  const total = sum(grouped(LEDGER, null).map((group) => group.risk));
  assert.ok(Math.abs(total - 0.009000001) < 1e-15);
});

test("a vehicle is the other of a pair, but not an obstacle of its name", () => {
  const causes = (vehicle) => grouped(LEDGER, vehicle).map((group) => group.cause);
  assert.deepEqual(causes("barge"), ["pair"]);
  assert.deepEqual(causes("tug"), ["pair", "workspace"]);
  assert.deepEqual(causes("nobody"), []);
});

test("risks stand at their steps, and lines beyond the end at the end", () => {
  const risks = risksBySteps([...LEDGER, line("pair", "a", "b", 99, 0.1)], 12, null);
  assert.equal(risks.pair[6], 0.002);
  assert.equal(risks.obstacle[6], 0.004);
  assert.equal(risks.pair[12], 0.1);
  assert.equal(risks.workspace.length, 13);
});

test("a hazard names both sides", () => {
  assert.equal(between(LEDGER[0]), "tug – barge");
  assert.equal(between(LEDGER[3]), "tug – edge");
});
