/**
 * The socket to the server: calls with answers, events, and coming back after a loss.
 *
 * A call made while the line is down waits for it. One that was sent and not answered when the line
 * broke fails as `gone`: nobody knows whether it was done, and the state that follows tells.
 */

import { signal } from "@preact/signals";
import { REFUSED, SOCKET, type CallName, type Calls, type Event, type Failure } from "./protocol";

/** `refused`: the token is not, or no longer, that of the server. */
export type Line = "connecting" | "open" | "lost" | "refused";

/** A call that the server turned down, in its words. */
export class CallError extends Error {
  readonly failure: Failure;

  constructor(failure: Failure) {
    super(failure.text);
    this.failure = failure;
  }
}

interface Waiting {
  readonly text: string;
  readonly resolve: (result: unknown) => void;
  readonly reject: (error: CallError) => void;
  isSent: boolean;
}

interface Incoming {
  readonly id?: number;
  readonly result?: unknown;
  readonly failure?: Failure;
  readonly event?: string;
}

/** Between attempts to come back [ms]: quickly at first, then in peace. */
const PAUSES = [200, 500, 1000, 2000, 4000];

const GONE: Failure = { kind: "gone", text: "the connection broke before the answer came", path: null };

export const line = signal<Line>("connecting");

/** Number of calls that have not been answered yet. */
export const pending = signal(0);

const waiting = new Map<number, Waiting>();
let listeners: readonly ((event: Event) => void)[] = [];
let openings: readonly (() => void)[] = [];
let socket: WebSocket | null = null;
let attempts = 0;
let last = 0;
let address = "";

/** Be told of every event. */
export function listen(listener: (event: Event) => void): void {
  listeners = [...listeners, listener];
}

/** Be told when the line is open, the first time and after each loss. */
export function onOpen(opening: () => void): void {
  openings = [...openings, opening];
}

/** Ask the server for something; fails with `CallError`. */
export function call<N extends CallName>(name: N, args: Calls[N][0]): Promise<Calls[N][1]> {
  last += 1;
  const id = last;
  return new Promise((resolve, reject) => {
    waiting.set(id, {
      text: JSON.stringify({ id, call: name, args }),
      resolve: (result) => resolve(result as Calls[N][1]),
      reject,
      isSent: false,
    });
    pending.value = waiting.size;
    sendAll();
  });
}

/** Open the line and keep it open. */
export function connect(token: string): void {
  const scheme = location.protocol === "https:" ? "wss:" : "ws:";
  address = `${scheme}//${location.host}${SOCKET}?token=${encodeURIComponent(token)}`;
  attempt();
}

function attempt(): void {
  const opened = new WebSocket(address);
  socket = opened;
  opened.onopen = () => {
    attempts = 0;
    line.value = "open";
    for (const opening of openings) opening();
    sendAll();
  };
  opened.onmessage = (message: MessageEvent<string>) => receive(message.data);
  opened.onclose = (closing) => {
    socket = null;
    failSent();
    if (closing.code === REFUSED) {
      line.value = "refused";
      return;
    }
    line.value = "lost";
    const pause = PAUSES[Math.min(attempts, PAUSES.length - 1)] ?? 0;
    attempts += 1;
    setTimeout(attempt, pause);
  };
}

function sendAll(): void {
  if (socket?.readyState !== WebSocket.OPEN) return;
  for (const call of waiting.values()) {
    if (call.isSent) continue;
    call.isSent = true;
    socket.send(call.text);
  }
}

function failSent(): void {
  for (const [id, call] of [...waiting]) {
    if (!call.isSent) continue;
    waiting.delete(id);
    call.reject(new CallError(GONE));
  }
  pending.value = waiting.size;
}

function receive(text: string): void {
  const message = JSON.parse(text) as Incoming;
  if (message.event !== undefined) {
    for (const listener of listeners) listener(message as unknown as Event);
    return;
  }
  const call = message.id === undefined ? undefined : waiting.get(message.id);
  if (call === undefined || message.id === undefined) return;
  waiting.delete(message.id);
  pending.value = waiting.size;
  if (message.failure === undefined) call.resolve(message.result);
  else call.reject(new CallError(message.failure));
}
