/** Answers that take their time: what is done meanwhile is done to the things it was meant for. */

import assert from "node:assert/strict";
import test from "node:test";
import { change, comparePlan, show, showPlan, undo } from "../src/actions.ts";
import { connect } from "../src/connection.ts";
import { insertAt } from "../src/edit/corners.ts";
import { addVehicle, addWaypoint, pick, remove } from "../src/edit/create.ts";
import { activeHandle, Drag } from "../src/edit/drag.ts";
import { after, nudge } from "../src/edit/nudge.ts";
import { document, echoes, scenario } from "../src/state/document.ts";
import { comparedId, shownId } from "../src/state/plans.ts";
import { selected } from "../src/state/selection.ts";
import { notice } from "../src/state/session.ts";

/** A server that answers when it is told to. */
class Socket {
  static OPEN = 1;
  readyState = 1;
  sent = [];

  constructor() {
    Socket.last = this;
  }

  send(text) {
    this.sent.push(JSON.parse(text));
  }

  say(message) {
    this.onmessage({ data: JSON.stringify(message) });
  }
}

globalThis.location = { protocol: "http:", host: "here" };
globalThis.sessionStorage = { setItem: () => undefined, getItem: () => null };
globalThis.WebSocket = Socket;
connect("");
const server = Socket.last;

const vehicle = (name, x = 0) => ({ name, start: [x, 0], goal: { center: [9, 9] } });

function viewOf({ vehicles }) {
  return {
    vehicles: vehicles.map(({ name, start }, i) => {
      const path = ["vehicles", i];
      const handle = { at: start, x: [[...path, "start", 0]], y: [[...path, "start", 1]], z: [] };
      return { name, path, start, startHandle: handle, goal: { path: [...path, "goal"], handles: [], box: null }, via: [] };
    }),
    obstacles: [],
    workspace: null,
  };
}

let revision = 0;

function stateOf(vehicles, id = "one") {
  revision += 1;
  const content = { vehicles };
  return { document: id, revision, content, view: viewOf(content), remarks: [], plans: [], searches: [], flights: [] };
}

function open(...vehicles) {
  server.sent.length = 0;
  pick(null);
  show(stateOf(vehicles));
}

const rest = () => new Promise((resolve) => setTimeout(resolve));

async function answer(call, result) {
  server.say({ id: call.id, result });
  await rest();
}

test("of two quick removals the second leaves alone what comes to be at the place of the first", async () => {
  open(vehicle("tug"), vehicle("ferry"));
  pick({ kind: "vehicle", path: ["vehicles", 0] });
  const thing = selected.peek();
  void remove(thing);
  void remove(thing);
  await rest();
  assert.equal(selected.peek(), null);
  await answer(server.sent[0], stateOf([vehicle("ferry")]));
  assert.deepEqual(server.sent.map(({ args }) => args.changes), [[{ path: ["vehicles", 0] }]]);
});

test("what is not removed after all is selected again", async () => {
  open(vehicle("tug"));
  const thing = { kind: "vehicle", path: ["vehicles", 0] };
  pick(thing);
  void remove(thing);
  await rest();
  server.say({ id: server.sent[0].id, failure: { kind: "refused", text: "no", path: null } });
  await rest();
  assert.deepEqual(selected.peek(), thing);
});

test("of two vehicles that are drawn one after the other the second does not replace the first", async () => {
  open(vehicle("tug"));
  void addVehicle([1, 1], [2, 2]);
  void addVehicle([3, 3], [4, 4]);
  await rest();
  const [first] = server.sent;
  assert.deepEqual(first.args.changes[0].path, ["vehicles", 1]);
  await answer(first, stateOf([vehicle("tug"), vehicle("vehicle 2", 1)]));
  const [made] = server.sent[1].args.changes;
  assert.deepEqual([made.path, made.value.name], [["vehicles", 2], "vehicle 3"]);
  await answer(server.sent[1], stateOf([vehicle("tug"), vehicle("vehicle 2", 1), vehicle("vehicle 3", 3)]));
});

test("a change that waits goes where its thing has gone, and nowhere where that was removed", async () => {
  open(vehicle("tug"), vehicle("ferry"), vehicle("pilot"));
  void change([{ path: ["vehicles", 0] }], "Remove tug");
  void change([{ path: ["vehicles", 2, "radius"], value: 1 }], "Set radius");
  const isDone = change([{ path: ["vehicles", 0, "radius"], value: 2 }], "Set radius");
  await rest();
  await answer(server.sent[0], stateOf([vehicle("ferry"), vehicle("pilot")]));
  assert.deepEqual(server.sent[1].args.changes, [{ path: ["vehicles", 1, "radius"], value: 1 }]);
  await answer(server.sent[1], stateOf([vehicle("ferry"), vehicle("pilot")]));
  assert.equal(await isDone, false);
  assert.equal(server.sent.length, 2);
});

test("a change that waits is not made to another document that was opened meanwhile", async () => {
  open(vehicle("tug"), vehicle("ferry"));
  void change([{ path: ["vehicles", 0] }], "Remove tug");
  const isDone = addVehicle([1, 1], [2, 2]);
  await rest();
  show(stateOf([vehicle("tug")], "two"));
  await answer(server.sent[0], stateOf([vehicle("ferry")]));
  await isDone;
  assert.equal(document.peek().document, "two");
  assert.equal(server.sent.length, 1);
  assert.equal(notice.peek().text, "Another document was opened before this was done: Add a vehicle");
});

test("a waypoint goes to its vehicle, wherever that has gone", async () => {
  open(vehicle("tug"), vehicle("ferry"));
  void change([{ path: ["vehicles", 0] }], "Remove tug");
  void addWaypoint({ kind: "goal", path: ["vehicles", 1, "goal"] }, [5, 5]);
  await rest();
  await answer(server.sent[0], stateOf([vehicle("ferry")]));
  assert.deepEqual(server.sent[1].args.changes[0].path, ["vehicles", 0, "via"]);
  await answer(server.sent[1], stateOf([vehicle("ferry")]));
});

test("what is selected and what is dragged stay so when another page removes what comes before", async () => {
  open(vehicle("tug"), vehicle("ferry", 2));
  pick({ kind: "vehicle", path: ["vehicles", 1] });
  const drag = new Drag(selected.peek(), 0);
  drag.show(1, 0);
  const state = stateOf([vehicle("ferry", 2)]);
  show(state);
  assert.deepEqual(selected.peek().path, ["vehicles", 0]);
  assert.deepEqual(scenario.value.vehicles.map(({ start }) => start), [[3, 0]]);
  void drag.finish();
  await rest();
  assert.deepEqual(server.sent[0].args.changes, [{ path: ["vehicles", 0, "start", 0], value: 3 }]);
  await answer(server.sent[0], stateOf([vehicle("ferry", 3)]));
  assert.deepEqual([echoes.peek(), scenario.value.vehicles[0].start], [[], [3, 0]]);
});

test("a drag of what was removed meanwhile moves nothing", async () => {
  open(vehicle("tug"), vehicle("ferry", 2));
  const drag = new Drag({ kind: "vehicle", path: ["vehicles", 0] }, 0);
  drag.show(1, 0);
  show(stateOf([vehicle("ferry", 2)]));
  await drag.finish();
  assert.deepEqual([server.sent, echoes.peek()], [[], []]);
  assert.deepEqual(scenario.value.vehicles[0].start, [2, 0]);
});

test("a second drag starts where the first has ended, answered or not", async () => {
  open(vehicle("tug"));
  const thing = { kind: "vehicle", path: ["vehicles", 0] };
  const first = new Drag(thing, 0);
  first.show(2, 0);
  void first.finish();
  const second = new Drag(thing, 0);
  assert.deepEqual(second.handle.at, [2, 0]);
  second.show(1, 0);
  assert.deepEqual(scenario.value.vehicles[0].start, [3, 0]);
  void second.finish();
  await rest();
  await answer(server.sent[0], stateOf([vehicle("tug", 2)]));
  assert.deepEqual(scenario.value.vehicles[0].start, [3, 0]);
  assert.deepEqual(server.sent[1].args.changes, [{ path: ["vehicles", 0, "start", 0], value: 3 }]);
  await answer(server.sent[1], stateOf([vehicle("tug", 3)]));
  assert.deepEqual([echoes.peek(), scenario.value.vehicles[0].start], [[], [3, 0]]);
});

test("of plans that were asked for the last is shown, in whatever order they come", async () => {
  open(vehicle("tug"));
  void showPlan("slow");
  void showPlan("quick");
  void comparePlan("slow");
  await rest();
  const [slow, quick, other] = server.sent;
  await answer(quick, { plan: "quick" });
  await answer(slow, { plan: "slow" });
  await answer(other, { plan: "slow" });
  assert.deepEqual([shownId.peek(), comparedId.peek()], ["quick", "slow"]);
  void showPlan("late");
  await rest();
  show(stateOf([vehicle("tug")], "two"));
  await answer(server.sent.at(-1), { plan: "late" });
  assert.deepEqual([document.peek().document, shownId.peek()], ["two", null]);
});

test("what is to be undone in one document is not undone in another that was opened meanwhile", async () => {
  open(vehicle("tug"));
  void change([{ path: ["vehicles", 0, "radius"], value: 1 }], "Set radius");
  void undo();
  await rest();
  show({ ...stateOf([vehicle("ferry")], "two"), canUndo: true });
  await answer(server.sent[0], stateOf([vehicle("tug")]));
  assert.deepEqual(server.sent.map(({ call }) => call), ["change"]);
});

test("what is asked for after keys have moved something is asked for after the move", async () => {
  globalThis.window = globalThis;
  open(vehicle("tug"), vehicle("ferry", 2));
  pick({ kind: "vehicle", path: ["vehicles", 0] });
  nudge(1, 0, 10);
  after(() => remove(selected.peek()));
  await rest();
  assert.equal(selected.peek(), null);
  await answer(server.sent[0], stateOf([vehicle("tug", 1), vehicle("ferry", 2)]));
  assert.deepEqual(server.sent.map(({ args }) => args.label), ["Move tug", "Remove tug"]);
  await answer(server.sent[1], stateOf([vehicle("ferry", 2)]));
});

test("a corner that is added to an outline leaves one where it was dragged meanwhile", async () => {
  const rock = (vertices, i = 0) => {
    const path = ["obstacles", i];
    const corners = vertices.map((at, k) => ({ at, x: [[...path, "vertices", k, 0]], y: [[...path, "vertices", k, 1]], z: [] }));
    const all = { at: vertices[0], x: corners.flatMap(({ x }) => x), y: corners.flatMap(({ y }) => y), z: [] };
    return { name: "rock", path, rings: [vertices], corners: [], handles: [all, ...corners] };
  };
  const stateWith = (vertices) => {
    const state = stateOf([]);
    const content = { vehicles: [], obstacles: [{ name: "rock", vertices }] };
    return { ...state, content, view: { ...state.view, obstacles: [rock(vertices)] } };
  };
  open();
  show(stateWith([[0, 0], [4, 0], [4, 4]]));
  const thing = { kind: "obstacle", path: ["obstacles", 0] };
  pick(thing);
  const drag = new Drag(thing, 3);
  drag.show(0, 2);
  void drag.finish();
  void insertAt([2, 0], 0.5);
  await rest();
  await answer(server.sent[0], stateWith([[0, 0], [4, 0], [4, 6]]));
  assert.deepEqual(server.sent[1].args.changes, [
    { path: ["obstacles", 0, "vertices"], value: [[0, 0], [2, 0], [4, 0], [4, 6]] },
  ]);
  await answer(server.sent[1], stateWith([[0, 0], [2, 0], [4, 0], [4, 6]]));
  assert.equal(activeHandle.peek(), 2);
});
