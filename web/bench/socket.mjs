/** A WebSocket server of text messages (RFC 6455), as little of it as a mock needs. */

import { createHash } from "node:crypto";

const MAGIC = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";

/** Take up a socket: `onText(text, send)` is called with each message. */
export function accept(request, socket, onText) {
  const key = createHash("sha1").update(request.headers["sec-websocket-key"] + MAGIC).digest("base64");
  socket.write(
    "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
      `Sec-WebSocket-Accept: ${key}\r\n\r\n`,
  );
  const send = (value) => socket.destroyed || socket.write(frame(JSON.stringify(value)));
  let bytes = Buffer.alloc(0);
  let parts = [];
  socket.on("data", (chunk) => {
    bytes = Buffer.concat([bytes, chunk]);
    for (let read = parse(bytes); read !== null; read = parse(bytes)) {
      bytes = bytes.subarray(read.length);
      if (read.code === 8) {
        socket.end();
      } else if (read.code < 3) {
        parts.push(read.payload);
        if (read.isLast) {
          onText(Buffer.concat(parts).toString(), send);
          parts = [];
        }
      }
    }
  });
  socket.on("error", () => socket.destroy());
  return send;
}

function frame(text) {
  const payload = Buffer.from(text);
  const { length } = payload;
  if (length < 126) return Buffer.concat([Buffer.from([0x81, length]), payload]);
  const head = Buffer.alloc(length < 65536 ? 4 : 10);
  head[0] = 0x81;
  if (length < 65536) {
    head[1] = 126;
    head.writeUInt16BE(length, 2);
  } else {
    head[1] = 127;
    head.writeBigUInt64BE(BigInt(length), 2);
  }
  return Buffer.concat([head, payload]);
}

function parse(bytes) {
  if (bytes.length < 2) return null;
  let length = bytes[1] & 127;
  let at = 2;
  if (length === 126) {
    if (bytes.length < 4) return null;
    length = bytes.readUInt16BE(2);
    at = 4;
  } else if (length === 127) {
    if (bytes.length < 10) return null;
    length = Number(bytes.readBigUInt64BE(2));
    at = 10;
  }
  if (bytes.length < at + 4 + length) return null;
  const mask = bytes.subarray(at, at + 4);
  const payload = Buffer.from(bytes.subarray(at + 4, at + 4 + length));
  for (let i = 0; i < length; i += 1) payload[i] ^= mask[i & 3];
  return { code: bytes[0] & 15, isLast: (bytes[0] & 128) !== 0, payload, length: at + 4 + length };
}
