import assert from "node:assert/strict";
import test from "node:test";
import { outlineSpots } from "../src/scene/layers/names.ts";
import { insideFirst, shortened } from "../src/scene/placing.ts";
import { HIGH, namePlaces } from "../src/space/naming.ts";

const AREA = 1000 * 700;
const overlap = (one, other) =>
  one.left < other.left + other.width && other.left < one.left + one.width
  && one.top < other.top + other.height && other.top < one.top + one.height;

/** Vehicles on a grid on the screen, `apart` pixels from one another. */
const grid = (count, apart) =>
  Array.from({ length: count }, (_, index) => ({
    px: 100 + apart * (index % 6),
    py: 100 + apart * Math.floor(index / 6),
    radius: 6,
    away: 20 + index,
    width: 48,
  }));

test("thirty drones with room are all named, off each other and off every drone", () => {
  const marks = grid(30, 80);
  const places = namePlaces(marks, [], AREA);
  assert.ok(places.every((place) => place !== null));
  places.forEach((place, index) => {
    assert.ok(places.every((other, at) => at === index || !overlap(place, other)));
    for (const { px, py, radius } of marks) {
      assert.ok(!overlap(place, { left: px - radius, top: py - radius, width: 2 * radius, height: 2 * radius }));
    }
  });
});

test("where it is crowded, names never lie on one another, and the nearest vehicle has its name", () => {
  const places = namePlaces(grid(30, 16), [], AREA);
  const written = places.filter((place) => place !== null);
  assert.ok(written.length > 0 && written.length < 30);
  written.forEach((place, index) => {
    assert.ok(written.every((other, at) => at === index || !overlap(place, other)));
  });
  assert.notEqual(places[0], null);
});

test("a name keeps off the numbers of axes", () => {
  const [mark] = grid(1, 0);
  const [free] = namePlaces([mark], [], AREA);
  const [moved] = namePlaces([mark], [free], AREA);
  assert.ok(!overlap(free, moved));
  assert.equal(moved.height, HIGH);
});

test("hundreds of vehicles in one picture have no names", () => {
  assert.ok(namePlaces(grid(300, 2), [], AREA).every((place) => place === null));
});

const CAMERA = { scale: 20, px: (x) => 20 * x, py: (y) => 600 - 20 * y };
const obstacle = (ring, only = null) => ({ name: "mole", kind: "polygon", rings: [ring], corners: [], moving: null, only });

test("the name of an obstacle lies on it, though its middle lies outside", () => {
  const hook = [[0, 0], [2, 0], [2, 6], [8, 6], [8, 8], [0, 8]];
  const [spot] = outlineSpots(obstacle(hook), CAMERA, 40);
  const [x, y] = [(spot.left + spot.width / 2) / 20, (600 - spot.top - spot.height / 2) / 20];
  assert.ok(y > 6 && y < 8 && x > 0 && x < 8, `at ${x}, ${y}`);
});

test("an obstacle narrower than its name has none", () => {
  assert.deepEqual(outlineSpots(obstacle([[0, 0], [1, 0], [1, 9], [0, 9]]), CAMERA, 40), []);
});

test("a name that is too long is shortened in its middle, where names differ least", () => {
  const fits = ({ length }) => length <= 12;
  assert.equal(shortened("tug", fits), "tug");
  const [one, two] = [1, 2].map((number) => shortened(`northern flotilla vessel ${number}`, fits));
  assert.equal(one, "northe…sel 1");
  assert.notEqual(one, two);
  assert.equal(shortened("渡し船".repeat(9), fits).length, 12);
  assert.equal(shortened("northern", () => false), "n…n");
});

test("a name beside a vehicle at the edge of the map stands within it, if any place does", () => {
  const [out, inside] = [{ left: 390, top: 10, width: 60, height: 12 }, { left: 300, top: 10, width: 60, height: 12 }];
  assert.deepEqual(insideFirst([out, inside], { width: 400, height: 300 }), [inside, out]);
});
