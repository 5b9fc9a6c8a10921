import assert from "node:assert/strict";
import test from "node:test";
import { show, takeFlight } from "../src/actions.ts";
import { follow, once } from "../src/panels/asking.ts";
import { pointAtLines } from "../src/panels/pointing.ts";
import { goTo, isFollowing, isPlaying, play, time } from "../src/state/playback.ts";
import { signal } from "@preact/signals";

globalThis.sessionStorage = { setItem: () => undefined, getItem: () => null };

const view = { horizon: 8, dt: 1, vehicles: [], obstacles: [], riskBound: 0.05 };
show({ document: "one", revision: 0, content: {}, view, remarks: [], plans: [], searches: [], flights: [] });
follow();

const fly = (step) => takeFlight({ flight: "f", document: "one", plan: null, state: "running", step, steps: 8, riskBound: 0.05, ticks: [], note: null });

test("time goes with a flight until the operator goes elsewhere in it, or plays", () => {
  fly(1);
  fly(2);
  assert.equal(time.peek(), 2);
  goTo(0);
  fly(3);
  assert.deepEqual([time.peek(), isFollowing.peek()], [0, false]);
  isFollowing.value = true;
  assert.equal(time.peek(), 3);
  play(true);
  fly(4);
  assert.deepEqual([time.peek(), isFollowing.peek(), isPlaying.peek()], [3, false, true]);
  isFollowing.value = true;
  assert.deepEqual([time.peek(), isPlaying.peek()], [4, false]);
});

test("of two quick clicks one asks", async () => {
  const is = signal(false);
  let asked = 0;
  let answer = () => undefined;
  const run = () => {
    asked += 1;
    return new Promise((resolve) => (answer = resolve));
  };
  const first = once(is, run);
  await once(is, run);
  assert.deepEqual([asked, is.peek()], [1, true]);
  answer();
  await first;
  void once(is, run);
  assert.equal(asked, 2);
});

test("a line of the ledger is pointed at while a flight goes on, which is followed again after", () => {
  isFollowing.value = true;
  fly(5);
  pointAtLines([{ vehicle: "tug", cause: "obstacle", other: "rock", step: 2, risk: 0.1, at: [0, 0] }]);
  fly(6);
  assert.equal(time.peek(), 2);
  pointAtLines(null);
  assert.deepEqual([time.peek(), isFollowing.peek()], [6, true]);
});
