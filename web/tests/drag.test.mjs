import assert from "node:assert/strict";
import test from "node:test";
import { cornersInstead } from "../src/edit/drag.ts";

const path = ["obstacles", 0];
const corners = [[10, 10], [14, 10], [14, 14], [10, 14]];
const numbers = (axis) => corners.map((_, j) => [...path, "vertices", j, axis]);
const handle = (at, x, y) => ({ at, x, y, z: [] });
const VIEW = {
  obstacles: [
    {
      name: "rock", path, kind: "polygon", rings: [corners], corners: [], triangles: [], moving: null, uncertain: null, only: null,
      handles: [
        handle([12, 12], numbers(0), numbers(1)),
        ...corners.map((at, j) => handle(at, [numbers(0)[j]], [numbers(1)[j]])),
      ],
    },
  ],
};
const CONTENT = { obstacles: [{ name: "rock", normals: [[1, 0]], offsets: [14], for: ["a"] }] };
const rock = { kind: "obstacle", path };

test("a corner of what is described by half-spaces is moved by writing all of its corners", () => {
  assert.deepEqual(cornersInstead(CONTENT, VIEW, rock, 3, 1.5, 0.25), [
    { path: [...path, "normals"] },
    { path: [...path, "offsets"] },
    { path: [...path, "vertices"], value: [[10, 10], [14, 10], [15.5, 14.25], [10, 14]] },
  ]);
  const [, , { value }] = cornersInstead(CONTENT, VIEW, rock, 0, -1, 0);
  assert.deepEqual(value, [[9, 10], [13, 10], [13, 14], [9, 14]]);
});

test("what is described by corners is moved by its own numbers", () => {
  assert.equal(cornersInstead({ obstacles: [{ name: "rock", vertices: corners }] }, VIEW, rock, 1, 1, 1), null);
});
