"use strict";
// A picture divided in two: the reference on the left, a technique or its error on the right. What is shown stands in the
// address, so that it can be sent: #viewer=hall&setting=2&view=error&split=30
const viewers = [...document.querySelectorAll(".viewer")].map((box) => {
  const images = document.getElementById(box.dataset.images);
  const figures = [...images.querySelectorAll("figure[data-setting]")];
  const reference = images.querySelector("figure[data-reference] img");
  const select = box.querySelector("select");
  const slider = box.querySelector("input[type=range]");
  const views = [...box.querySelectorAll("input[type=radio]")];
  const stage = box.querySelector(".stage");
  const left = stage.appendChild(new Image());
  const right = stage.appendChild(new Image());
  const copy = (to, from) => {
    to.src = from.src;
    to.alt = from.alt;
    to.width = from.width = Number(from.getAttribute("width"));
    to.height = from.height = Number(from.getAttribute("height"));
  };

  const show = (tell) => {
    const view = views.find((choice) => choice.checked).value;
    const figure = figures[Number(select.value)];
    const split = Number(slider.value);
    copy(left, reference);
    copy(right, figure.querySelector(`img.${view}`));
    stage.style.setProperty("--split", `${split}%`);
    slider.setAttribute("aria-valuetext", `${split} % reference, ${100 - split} % ${view}`);
    box.querySelector(".shown").textContent = figure.querySelector("figcaption").textContent;
    box.querySelector(".scale").hidden = view !== "error";
    if (tell) {
      const state = new URLSearchParams({ viewer: box.dataset.name, setting: select.value, view, split });
      history.replaceState(null, "", `#${state}`);
    }
  };
  const restore = (state) => {
    const setting = Number(state.get("setting"));
    if (figures[setting]) select.value = String(setting);
    const view = views.find((choice) => choice.value === state.get("view"));
    if (view) view.checked = true;
    const split = Number(state.get("split") ?? "50");
    if (split >= 0 && split <= 100) slider.value = String(split);
    show(false);
    box.scrollIntoView();
  };
  const drag = (event) => {
    if (event.buttons !== 1) return;
    const bounds = stage.getBoundingClientRect();
    slider.value = String(Math.round((100 * (event.clientX - bounds.left)) / bounds.width));
    show(true);
  };

  for (const control of [select, slider, ...views]) control.addEventListener("input", () => show(true));
  stage.addEventListener("pointerdown", drag);
  stage.addEventListener("pointermove", drag);
  box.hidden = false;
  show(false);
  return { name: box.dataset.name, restore };
});

const follow = () => {
  const state = new URLSearchParams(location.hash.slice(1));
  viewers.find((viewer) => viewer.name === state.get("viewer"))?.restore(state);
};
addEventListener("hashchange", follow);
follow();
