import assert from "node:assert/strict";
import test from "node:test";
import { Vector3 } from "three";
import { Orbit } from "../src/space/orbit.ts";

const HOST = { addEventListener() {}, clientHeight: 700 };
const BOXES = [
  { min: [-1, -1, 0], max: [25, 25, 20] },
  { min: [0, 0, 0], max: [300, 2, 2] },
  { min: [0, 0, 0], max: [2, 2, 300] },
  { min: [0, 0, 0], max: [20, 14, 8] },
];

for (const [width, height] of [[1280, 624], [375, 170], [300, 900]]) {
  for (const box of BOXES) {
    test(`all of a box to ${box.max} is to be seen at ${width} by ${height} pixels, and it fills them`, () => {
      const orbit = new Orbit(HOST, () => {});
      orbit.resize(width, height);
      orbit.fit(box);
      const { camera } = orbit;
      let reach = 0;
      for (let k = 0; k < 8; k += 1) {
        const corner = [0, 1, 2].map((axis) => (((k >> axis) & 1) === 0 ? box.min : box.max)[axis]);
        const { x, y } = new Vector3(...corner).project(camera);
        reach = Math.max(reach, Math.abs(x), Math.abs(y));
      }
      assert.ok(reach < 0.95 && reach > 0.75, `the farthest corner is at ${reach} of half the picture`);
    });
  }
}
