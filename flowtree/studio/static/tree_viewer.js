import { TreeViewer } from "flowtree-studio/tree_viewer.mjs";

export default {
  template: "<div></div>",
  mounted() {
    try {
      this.viewer = new TreeViewer(this.$el, (name, value) => this.$emit(name, value));
    } catch (error) {
      this.$el.textContent = `This browser cannot show the tree in space: ${error.message}`;
      this.$el.classList.add("tree-viewer", "unable");
    }
  },
  methods: {
    set_layer(name, layer) {
      this.viewer?.setLayer(name, layer);
    },
    remove_layer(name) {
      this.viewer?.removeLayer(name);
    },
    set_shown(shown) {
      this.viewer?.setShown(shown);
    },
    set_look(look) {
      this.viewer?.setLook(look);
    },
    set_view(index) {
      this.viewer?.setView(index);
    },
    set_blend(blend) {
      this.viewer?.setBlend(blend);
    },
    set_measuring(on) {
      this.viewer?.setMeasuring(on);
    },
    frame() {
      this.viewer?.setView(null);
    },
    play() {
      this.viewer?.player.toggle();
    },
    screenshot(name) {
      if (!this.viewer) return;
      const link = document.createElement("a");
      link.href = this.viewer.screenshot();
      link.download = name;
      link.click();
    },
  },
};
