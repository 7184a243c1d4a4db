/**
 * Mouse, pen and fingers on the board: draw with the first button, pan with the second, third or Space, zoom with the
 * wheel; two fingers pan and zoom.
 */

/**
 * @param {HTMLCanvasElement} canvas
 * @param {object} board with begin, finish, cancel, pan, zoom, hover, drawInk; its `live` is set here
 * @returns {{panning: boolean, busy: boolean}} whether the next drag pans, and whether a gesture is under way
 */
export function watchPointers(canvas, board) {
  const status = { panning: false, busy: false };
  const fingers = new Map();
  let drag = null; // {id, kind: "draw" | "pan", at}

  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.x, event.clientY - box.y];
  };

  const stop = (how) => {
    const { live } = board;
    status.busy = false;
    drag = null;
    if (live) board[how](live);
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    const at = place(event);
    if (event.pointerType === "touch") fingers.set(event.pointerId, at);
    if (fingers.size === 2) {
      stop("cancel");
      return;
    }
    if (drag) return; // a palm beside the pen
    if (event.button !== 0 || status.panning) {
      drag = { id: event.pointerId, kind: "pan", at };
      return;
    }
    board.live = board.begin(at);
    status.busy = board.live !== null;
    drag = board.live ? { id: event.pointerId, kind: "draw", at } : null;
    board.drawInk();
  });

  canvas.addEventListener("pointermove", (event) => {
    const at = place(event);
    if (fingers.size === 2 && fingers.has(event.pointerId)) {
      pinch(fingers, event.pointerId, at, board);
      return;
    }
    if (drag?.id === event.pointerId && drag.kind === "pan") {
      board.pan(at[0] - drag.at[0], at[1] - drag.at[1]);
      drag.at = at;
    } else if (drag?.id === event.pointerId) {
      const between = event.getCoalescedEvents?.() ?? [];
      board.live.move(between.length > 0 ? between.map(place) : [at]);
    }
    board.hover(event.pointerType === "touch" ? null : at);
  });

  const up = (how) => (event) => {
    fingers.delete(event.pointerId);
    if (drag?.id !== event.pointerId) return;
    if (drag.kind === "draw") stop(how);
    drag = null;
  };
  canvas.addEventListener("pointerup", up("finish"));
  canvas.addEventListener("pointercancel", up("cancel"));
  canvas.addEventListener("pointerleave", () => board.hover(null));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 30 : 1;
      board.zoom(Math.exp(-event.deltaY * lines * 0.0015), place(event));
    },
    { passive: false },
  );
  return status;
}

/** Two fingers: their middle moves the picture, their distance scales it. */
function pinch(fingers, id, at, board) {
  const [first, second] = [...fingers.values()];
  const middle = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const apart = (a, b) => Math.max(Math.hypot(a[0] - b[0], a[1] - b[1]), 1);
  const before = { at: middle(first, second), apart: apart(first, second) };
  fingers.set(id, at);
  const [a, b] = [...fingers.values()];
  const now = middle(a, b);
  board.pan(now[0] - before.at[0], now[1] - before.at[1]);
  board.zoom(apart(a, b) / before.apart, now);
}
