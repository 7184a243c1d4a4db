/** Files that are dropped on the page, or chosen in a dialog, on their way to the studio's server. */

/** The address that takes a file: photos become views, an archive is opened as a project. */
export function addressFor(name, parameter = null) {
  const query = `?name=${encodeURIComponent(name)}`;
  if (parameter) return `/picture/${parameter}${query}`;
  return /\.zip$/i.test(name) ? `/open${query}` : `/photo${query}`;
}

/**
 * Sends files one after another; they keep their order.
 *
 * @param {Iterable<File>} files
 * @param {(message: string) => void} onProblem
 */
export async function sendFiles(files, onProblem, parameter = null) {
  for (const file of files) {
    document.body.classList.add("sending");
    try {
      const answer = await fetch(addressFor(file.name, parameter), { method: "POST", body: file });
      if (!answer.ok) onProblem((await answer.json().catch(() => ({}))).message ?? `${file.name}: refused`);
    } catch {
      onProblem(`${file.name}: the studio did not answer; is it still running?`);
    } finally {
      document.body.classList.remove("sending");
    }
  }
}

/** Asks for files, then sends them. */
export function chooseFiles(accept, onProblem, parameter = null) {
  const input = document.createElement("input");
  Object.assign(input, { type: "file", multiple: !parameter, accept });
  input.addEventListener("change", () => sendFiles(input.files, onProblem, parameter));
  input.click();
}

/** Takes files that are dropped anywhere. Elements with `data-choose` (what a dialog accepts) ask for files. */
export function installDrop(onProblem) {
  const hasFiles = (event) => event.dataTransfer?.types.includes("Files");
  const over = (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    document.body.classList.add("dropping");
  };
  const leave = (event) => {
    if (event.relatedTarget === null) document.body.classList.remove("dropping");
  };
  const drop = (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    document.body.classList.remove("dropping");
    sendFiles(event.dataTransfer.files, onProblem);
  };
  const click = (event) => {
    const asked = event.target.closest?.("[data-choose]");
    if (asked) chooseFiles(asked.dataset.choose, onProblem, asked.dataset.parameter ?? null);
  };
  const listeners = { dragover: over, dragleave: leave, drop, click };
  for (const [name, listener] of Object.entries(listeners)) window.addEventListener(name, listener);
  return () => {
    for (const [name, listener] of Object.entries(listeners)) window.removeEventListener(name, listener);
  };
}
