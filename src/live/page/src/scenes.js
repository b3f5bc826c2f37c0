// The list of scenes, with pictures.
import { withToken } from "./connection.js";
import { element, notice } from "./panel.js";

function pictureOf({ name, picture }) {
  const holder = document.createElement(picture ? "img" : "div");
  if (!picture) holder.className = "no-picture";
  else Object.assign(holder, { src: picture, alt: "", loading: "lazy" });
  if (!picture) holder.textContent = name;
  return holder;
}

export class Scenes {
  constructor(send) {
    this.dialog = element("scenes");
    this.send = send;
    element("open-scenes").addEventListener("click", () => this.open());
  }

  async open() {
    try {
      const answer = await fetch(withToken("scenes"));
      if (!answer.ok) throw new Error(`status ${answer.status}`);
      this.show(await answer.json());
    } catch (error) {
      notice("error", `the list of scenes did not arrive: ${error.message}`);
    }
  }

  show(scenes) {
    const items = scenes.map((scene) => {
      const item = document.createElement("li"), button = document.createElement("button");
      const name = document.createElement("b"), summary = document.createElement("span");
      button.type = "button";
      button.setAttribute("aria-current", String(scene.name === this.current));
      button.disabled = !this.allowed;
      name.textContent = scene.name;
      summary.textContent = scene.summary;
      button.append(pictureOf(scene), name, summary);
      button.addEventListener("click", () => {
        this.send({ type: "open", scene: scene.name });
        this.dialog.close();
      });
      item.append(button);
      return item;
    });
    element("scene-list").replaceChildren(...items);
    this.dialog.showModal();
  }
}
