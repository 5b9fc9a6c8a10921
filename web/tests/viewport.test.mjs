import assert from "node:assert/strict";
import test from "node:test";
import { show } from "../src/actions.ts";
import { camera, fit, pan, resize } from "../src/scene/viewport.ts";

globalThis.sessionStorage = { setItem: () => undefined, getItem: () => null };

const view = { vehicles: [], obstacles: [], extent: { min: [0, 0], max: [40, 20] } };
show({ document: "one", revision: 0, content: {}, view, remarks: [], plans: [], searches: [], flights: [] });

const isAllInView = () => {
  const { width, height } = camera.peek();
  const [left, low] = camera.peek().toScreen(0, 0);
  const [right, high] = camera.peek().toScreen(40, 20);
  return left >= 0 && right <= width && high >= 0 && low <= height;
};

test("a map that shows all still does in another size", () => {
  resize(800, 400);
  assert.ok(isAllInView());
  resize(300, 90);
  assert.ok(isAllInView());
});

test("where the operator has looked elsewhere, another size leaves it at that", () => {
  resize(800, 400);
  pan(30, 0);
  const { x, y, scale } = camera.peek();
  resize(300, 90);
  assert.deepEqual([camera.peek().x, camera.peek().y, camera.peek().scale], [x, y, scale]);
  fit();
  resize(800, 400);
  assert.ok(isAllInView());
});
