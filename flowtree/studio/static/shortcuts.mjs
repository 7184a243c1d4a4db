/** The studio's keys. */

const KEYS = {
  1: "mode arrange",
  2: "mode matte",
  3: "mode branches",
  4: "mode density",
  "[": "size down",
  "]": "size up",
  f: "frame",
  h: "help",
  "?": "help",
  e: "erase",
  v: "view next",
  w: "wireframe",
  m: "measure",
  p: "play",
  Escape: "escape",
  ArrowLeft: "nudge -1 0",
  ArrowRight: "nudge 1 0",
  ArrowUp: "nudge 0 -1",
  ArrowDown: "nudge 0 1",
};

/**
 * What a pressed key asks for.
 *
 * @param {{key: string, ctrlKey?: boolean, metaKey?: boolean, shiftKey?: boolean, altKey?: boolean}} event
 * @returns {string | null}
 */
export function actionOf({ key, ctrlKey = false, metaKey = false, shiftKey = false, altKey = false }) {
  const letter = key.length === 1 ? key.toLowerCase() : key;
  if (altKey) return null;
  if (ctrlKey || metaKey) {
    if (letter === "z") return shiftKey ? "redo" : "undo";
    return { y: "redo", e: "export", Enter: "run" }[letter] ?? null;
  }
  return KEYS[letter] ?? null;
}

/** Whether a key belongs to the thing that has the focus: text is written there, a slider moved. */
function isTaken(event) {
  const { target } = event;
  if (target.isContentEditable || target.tagName === "TEXTAREA" || target.tagName === "SELECT") return true;
  const typed = target.tagName === "INPUT" && !["range", "checkbox", "radio", "button"].includes(target.type);
  if (typed) return true;
  const arrow = event.key.startsWith("Arrow");
  return arrow && (target.tagName === "INPUT" || target.closest?.("[role=slider], .q-menu"));
}

/**
 * @param {(action: string) => void} onAction
 * @param {(held: boolean) => void} onSpace while Space is held, dragging pans
 * @returns {() => void} takes the keys away again
 */
export function installShortcuts(onAction, onSpace) {
  const down = (event) => {
    if (event.defaultPrevented || isTaken(event)) return;
    const onButton = event.target.tagName === "BUTTON" || event.target.getAttribute?.("role") === "button";
    if (event.key === " " && !onButton) {
      event.preventDefault();
      if (!event.repeat) onSpace(true);
      return;
    }
    const action = actionOf(event);
    if (!action) return;
    if (event.repeat && !/^(nudge|size|undo|redo)/.test(action)) return;
    event.preventDefault();
    onAction(action);
  };
  const up = (event) => {
    if (event.key === " ") onSpace(false);
  };
  const blur = () => onSpace(false);
  window.addEventListener("keydown", down);
  window.addEventListener("keyup", up);
  window.addEventListener("blur", blur);
  return () => {
    window.removeEventListener("keydown", down);
    window.removeEventListener("keyup", up);
    window.removeEventListener("blur", blur);
  };
}
