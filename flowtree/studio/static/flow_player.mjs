/** Play, pause and scrub: a button and a slider over the viewer for the time of the flow. */

const SECONDS = 9; // from the first particle's start to the last one's arrival

export class FlowPlayer {
  constructor(host, onTime) {
    this.onTime = onTime;
    this.length = 1;
    this.time = 0;
    this.playing = false;
    this.bar = host.appendChild(document.createElement("div"));
    this.bar.className = "flow-player";
    this.button = this.bar.appendChild(document.createElement("button"));
    this.button.type = "button";
    this.slider = this.bar.appendChild(document.createElement("input"));
    Object.assign(this.slider, { type: "range", min: 0, max: 1000, value: 0, ariaLabel: "Time of the flow" });
    this.button.addEventListener("click", () => this.toggle());
    this.slider.addEventListener("input", () => {
      this.pause();
      this.#set((this.slider.value / 1000) * this.length);
    });
    this.pause();
    this.setShown(false);
  }

  setShown(shown) {
    this.bar.style.display = shown ? "" : "none";
    if (!shown) this.pause();
  }

  /** @param {number} length [steps]; a new flow is shown at its end */
  setLength(length) {
    this.length = length;
    this.#set(length);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (this.time >= this.length) this.#set(0);
    this.playing = true;
    this.#label("pause", "Pause the flow");
    let before = performance.now();
    const tick = (now) => {
      if (!this.playing) return;
      this.#set(Math.min(this.time + ((now - before) / 1000 / SECONDS) * this.length, this.length));
      before = now;
      if (this.time >= this.length) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  pause() {
    this.playing = false;
    this.#label("play_arrow", "Play the flow");
  }

  #label(icon, text) {
    this.button.innerHTML = `<i class="material-icons">${icon}</i>`;
    this.button.ariaLabel = this.button.title = text;
  }

  #set(time) {
    this.time = time;
    this.slider.value = Math.round((time / this.length) * 1000);
    this.onTime();
  }
}
