/** Connect the page to its server, again and again, and find the server's clock. */
'use strict';

const PINGS = 6;
const RETRY_MS = 1000;

/**
 * Create the connection.
 *
 * The clock of the walk is found once, from the quickest of some answers, so that it never jumps under a recording.
 *
 * @param onMessage  called with each message, an object with a `type`
 * @param onState  called with true when the connection is open and with false when it is lost
 * @returns send(message), isOpen(), now_s(at_ms): time of the walk at a time of performance.now(); NaN at first
 */
function createLink(onMessage, onState) {
  const address = new URL('link', location.href);
  address.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
  let socket = null;
  let zero_s = NaN;
  let quickest_ms = Infinity;
  let answers = 0;

  function open() {
    socket = new WebSocket(address);
    socket.onopen = () => { onState(true); ping(); };
    socket.onmessage = (event) => take(JSON.parse(event.data));
    socket.onclose = (event) => { onState(false, event.reason); setTimeout(open, RETRY_MS); };
  }

  function ping() {
    if (answers < PINGS && isOpen()) send({ type: 'ping', sent: performance.now() });
  }

  function take(message) {
    if (message.type !== 'pong') { onMessage(message); return; }
    const now_ms = performance.now();
    answers += 1;
    if (now_ms - message.sent < quickest_ms) {
      quickest_ms = now_ms - message.sent;
      zero_s = message.now_s - (now_ms + message.sent) / 2000;
    }
    if (answers < PINGS) setTimeout(ping, 20);
    else onMessage({ type: 'clock' });
  }

  function isOpen() { return socket !== null && socket.readyState === WebSocket.OPEN; }

  function send(message) {
    if (isOpen()) socket.send(JSON.stringify(message));
  }

  open();
  return { send, isOpen, now_s: (at_ms = performance.now()) => (answers >= PINGS ? zero_s + at_ms / 1000 : NaN) };
}
