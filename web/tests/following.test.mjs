import assert from "node:assert/strict";
import test from "node:test";
import { followed } from "../src/state/following.ts";

const vehicle = (name, more = {}) => ({ name, start: [0, 0], ...more });
const via = (x) => ({ center: [x, 0] });
const BEFORE = {
  vehicles: [vehicle("tug"), vehicle("ferry", { via: [via(1), via(2)] })],
  obstacles: [{ vertices: [[0, 0], [1, 0], [1, 1], [0, 1]] }, { min: [5, 5], max: [6, 6] }],
};
const [tug, ferry] = BEFORE.vehicles;
const [square, box] = BEFORE.obstacles;

test("what has a name is followed to another place of its list", () => {
  const after = { ...BEFORE, vehicles: [ferry] };
  assert.deepEqual(followed(BEFORE, after, ["vehicles", 1, "start", 0]), ["vehicles", 0, "start", 0]);
  assert.deepEqual(followed(after, BEFORE, ["vehicles", 0]), ["vehicles", 1]);
  assert.deepEqual(followed(BEFORE, { ...BEFORE, vehicles: [ferry, tug] }, ["vehicles", 0]), ["vehicles", 1]);
});

test("what was removed is found nowhere", () => {
  assert.equal(followed(BEFORE, { ...BEFORE, vehicles: [ferry] }, ["vehicles", 0, "radius"]), null);
  assert.equal(followed(BEFORE, { ...BEFORE, vehicles: [] }, ["vehicles", 1]), null);
  assert.equal(followed(BEFORE, { ...BEFORE, obstacles: [box] }, ["obstacles", 0]), null);
});

test("what was renamed or changed stays at its place", () => {
  assert.deepEqual(followed(BEFORE, { ...BEFORE, vehicles: [vehicle("barge"), ferry] }, ["vehicles", 0]), ["vehicles", 0]);
  const wider = { ...BEFORE, obstacles: [square, { ...box, max: [9, 6] }] };
  assert.deepEqual(followed(BEFORE, wider, ["obstacles", 1, "max", 0]), ["obstacles", 1, "max", 0]);
});

test("what has no name is followed by what it is", () => {
  assert.deepEqual(followed(BEFORE, { ...BEFORE, obstacles: [box] }, ["obstacles", 1]), ["obstacles", 0]);
  const fewer = { ...BEFORE, vehicles: [{ ...ferry, via: [via(2)] }] };
  assert.deepEqual(followed(BEFORE, fewer, ["vehicles", 1, "via", 1]), ["vehicles", 0, "via", 0]);
  assert.equal(followed(BEFORE, fewer, ["vehicles", 1, "via", 0]), null);
  const moved = { ...square, vertices: [[0, 0], [2, 0], [1, 1], [0, 1]] };
  assert.deepEqual(followed(BEFORE, { ...BEFORE, obstacles: [moved, box] }, ["obstacles", 0, "vertices", 1, 0]), ["obstacles", 0, "vertices", 1, 0]);
});

test("what is appended comes after what others have appended", () => {
  const more = { ...BEFORE, vehicles: [tug, ferry, vehicle("barge")] };
  assert.deepEqual(followed(BEFORE, more, ["vehicles", 2]), ["vehicles", 3]);
  assert.deepEqual(followed(BEFORE, more, ["risk_bound"]), ["risk_bound"]);
});
