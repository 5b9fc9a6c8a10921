import assert from "node:assert/strict";
import test from "node:test";
import { moved } from "../src/edit/drag.ts";
import { fieldsOf } from "../src/edit/fields.ts";
import { handlesOf, nameOf, thingAt, vehicleAt } from "../src/edit/things.ts";

function vehicle(name, index) {
  const path = ["vehicles", index];
  const startHandle = { at: [index, 0], x: [[...path, "start", 0]], y: [[...path, "start", 1]], z: [] };
  return { name, path, start: [index, 0], startHandle, goal: { path: [...path, "goal"], handles: [] }, via: [] };
}

/** Of the document's three vehicles the first cannot be drawn. */
const VIEW = { vehicles: [vehicle("pilot", 1), vehicle("ferry", 2)], obstacles: [], workspace: null };
const ferry = { kind: "vehicle", path: ["vehicles", 2] };
const pilot = { kind: "vehicle", path: ["vehicles", 1] };

test("where a vehicle cannot be drawn the others are still themselves", () => {
  assert.deepEqual([nameOf(VIEW, pilot), nameOf(VIEW, ferry)], ["pilot", "ferry"]);
  assert.deepEqual(handlesOf(VIEW, ferry)[0].at, [2, 0]);
  const { vehicles } = moved(VIEW, pilot, 0, 5, 0);
  assert.deepEqual(vehicles.map(({ start }) => start), [[6, 0], [2, 0]]);
});

test("what cannot be drawn, and the list as a whole, are no vehicle", () => {
  assert.equal(vehicleAt(VIEW, ["vehicles", 0]), null);
  assert.equal(vehicleAt(VIEW, ["vehicles"]), null);
  assert.equal(thingAt({ ...VIEW, vehicles: [] }, ["vehicles"]), null);
});

test("all that a scenario and its defaults say is shown, in words", () => {
  const content = { keep: [], source: {}, covariance_samples: 40, defaults: { radius: 1, feedback: {}, control_sigmas: 4 } };
  const [scenario, defaults] = fieldsOf(content, null).map(({ rows }) => rows.map(({ label }) => label));
  assert.deepEqual(scenario.slice(-3), ["Ranges to keep", "Source", "Covariance samples"]);
  assert.deepEqual(defaults.slice(-2), ["Feedback", "Control sigmas"]);
});
