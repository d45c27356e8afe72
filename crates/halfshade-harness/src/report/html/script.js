"use strict";

// Tables: a click on a head sorts by it, numbers as numbers, once more turns the order round; what is no number comes last.
for (const table of document.querySelectorAll("table")) {
  const heads = [...table.querySelectorAll("thead th")];
  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
    const falling = head.getAttribute("aria-sort") === "ascending";
    heads.forEach(other => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", falling ? "descending" : "ascending");
    const sign = falling ? -1 : 1;
    const key = row => row.cells[column] ?? null;
    const compare = (a, b) => {
      const [left, right] = [key(a), key(b)];
      const [x, y] = [left?.dataset.value, right?.dataset.value];
      if (x !== undefined && y !== undefined) return sign * (Number(x) - Number(y));
      if (x !== undefined || y !== undefined) return x !== undefined ? -1 : 1;
      return sign * (left?.textContent ?? "").localeCompare(right?.textContent ?? "", undefined, { numeric: true });
    };
    const body = table.tBodies[0];
    [...body.rows].sort(compare).forEach(row => body.append(row));
  }));
}

// Linear light of an 8-bit sRGB value.
const linear = value => {
  const share = value / 255;
  return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
};

// Pixels of a picture, read once.
const pixels = image => {
  if (!image.read) {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
    const context = canvas.getContext("2d", { willReadFrequently: true });
    context.drawImage(image, 0, 0);
    image.read = context.getImageData(0, 0, canvas.width, canvas.height);
  }
  return image.read;
};

let viewers = 0;

// Two pictures of a gallery over each other, with a slider between them or one instead of the other, zoomed and exposed in step.
function viewer(gallery) {
  const figures = [...gallery.querySelectorAll("figure")];
  if (figures.length < 2) return;
  const labels = figures.map(figure => figure.dataset.label);
  const number = viewers++;
  const box = document.createElement("div");
  box.className = "viewer";
  const options = labels.map((_, place) => `<option value="${place}"></option>`).join("");
  box.innerHTML = `
    <div class="controls">
      <label>left <select class="first">${options}</select></label>
      <label>right <select class="second">${options}</select></label>
      <label><input type="radio" name="mode${number}" value="slider" checked> slider</label>
      <label><input type="radio" name="mode${number}" value="flip"> flip (space)</label>
      <label><input type="radio" name="mode${number}" value="error"> error of the left</label>
      <label class="flip"><input type="radio" name="mode${number}" value="map"> FLIP of the left</label>
      <label>exposure <input type="range" class="stops" min="-6" max="6" step="0.25" value="0"> <span class="told">0 stops</span></label>
      <button type="button" class="closer" aria-label="zoom in">+</button>
      <button type="button" class="farther" aria-label="zoom out">−</button>
      <button type="button" class="whole">whole</button>
    </div>
    <div class="stage" tabindex="0" role="img" aria-label="two pictures over each other; arrows move the slider or the picture, plus and minus zoom, space flips">
      <div class="layer under"><img alt=""></div><div class="layer over"><img alt=""></div><div class="divider"></div>
    </div>
    <output></output>
    <div class="bar"><span>error: too dark −25 %</span><span class="scale"></span><span>+25 % too bright, of the mean unshadowed radiance</span></div>
    <div class="bar flip"><span>FLIP: 0</span><span class="magma"></span><span>1</span></div>
    <svg width="0" height="0" aria-hidden="true"><filter id="exposure${number}" color-interpolation-filters="linearRGB"><feComponentTransfer><feFuncR type="linear"/><feFuncG type="linear"/><feFuncB type="linear"/></feComponentTransfer></filter></svg>`;
  gallery.before(box);
  if (!gallery.querySelector("img.flip")) box.querySelectorAll(".flip").forEach(part => part.remove());
  const find = selector => box.querySelector(selector);
  const [first, second, stage, output, stops] = [".first", ".second", ".stage", "output", ".stops"].map(find);
  const [under, over] = [find(".under img"), find(".over img")];
  for (const select of [first, second]) [...select.options].forEach((option, place) => (option.textContent = labels[place]));
  const truth = Math.max(labels.indexOf("truth"), 0);
  first.value = labels.findIndex((_, place) => place !== truth);
  second.value = truth;
  const state = { split: 0.5, scale: 1, x: 0, y: 0, shown: false };
  const mode = () => find(`input[name=mode${number}]:checked`).value;
  const picture = select => figures[select.value].querySelector("img.picture");
  const map = () => ({ error: "img.error", map: "img.flip" })[mode()];

  const draw = () => {
    const top = (map() && figures[first.value].querySelector(map())) ?? picture(first);
    over.src = top.src;
    under.src = picture(second).src;
    const natural = picture(second);
    stage.style.aspectRatio = `${natural.naturalWidth || 4} / ${natural.naturalHeight || 3}`;
    stage.style.width = `min(100%, ${2 * (natural.naturalWidth || 320)}px)`;
    const transform = `translate(${state.x}px, ${state.y}px) scale(${state.scale})`;
    for (const image of [under, over]) image.style.transform = transform;
    const slope = 2 ** stops.value;
    for (const part of box.querySelectorAll("filter *")) part.setAttribute("slope", slope);
    const filter = Number(stops.value) === 0 ? "" : `url(#exposure${number})`;
    under.style.filter = filter;
    over.style.filter = map() ? "" : filter;
    find(".told").textContent = `${stops.value} stops`;
    const sliding = mode() === "slider";
    find(".divider").hidden = !sliding;
    find(".divider").style.left = `${100 * state.split}%`;
    find(".over").style.clipPath = sliding ? `inset(0 ${100 * (1 - state.split)}% 0 0)` : "";
    find(".over").style.visibility = mode() === "flip" && state.shown ? "hidden" : "visible";
  };

  const zoom = (factor, x, y) => {
    const scale = Math.min(Math.max(state.scale * factor, 1), 32);
    const change = scale / state.scale;
    [state.x, state.y, state.scale] = [x - change * (x - state.x), y - change * (y - state.y), scale];
    const bound = (value, size) => Math.min(0, Math.max(value, size * (1 - scale)));
    [state.x, state.y] = [bound(state.x, stage.clientWidth), bound(state.y, stage.clientHeight)];
    draw();
  };
  const middle = factor => zoom(factor, stage.clientWidth / 2, stage.clientHeight / 2);

  // Values under the pointer, in linear light as the pictures show it.
  const tell = (x, y) => {
    const [a, b] = [picture(first), picture(second)];
    const column = Math.floor(((x - state.x) / state.scale / stage.clientWidth) * a.naturalWidth);
    const row = Math.floor(((y - state.y) / state.scale / stage.clientHeight) * a.naturalHeight);
    if (column < 0 || row < 0 || column >= a.naturalWidth || row >= a.naturalHeight) return;
    const value = image => {
      const data = pixels(image).data;
      const place = 4 * (row * image.naturalWidth + column);
      return [0, 1, 2].map(channel => linear(data[place + channel]));
    };
    const [left, right] = [value(a), value(b)];
    const text = values => values.map(number => number.toFixed(3)).join(" ");
    const difference = left.map((number, channel) => number - right[channel]);
    output.textContent = `pixel ${column}, ${row}: ${labels[first.value]} ${text(left)} · ${labels[second.value]} ${text(right)} · difference ${text(difference)} (red green blue, white = 1)`;
  };

  let drag = null;
  stage.addEventListener("pointerdown", event => {
    drag = { x: event.clientX - state.x, y: event.clientY - state.y };
    stage.setPointerCapture(event.pointerId);
  });
  stage.addEventListener("pointerup", () => (drag = null));
  stage.addEventListener("pointermove", event => {
    const bounds = stage.getBoundingClientRect();
    const [x, y] = [event.clientX - bounds.left, event.clientY - bounds.top];
    tell(x, y);
    if (drag && state.scale > 1) {
      [state.x, state.y] = [event.clientX - drag.x, event.clientY - drag.y];
      zoom(1, 0, 0);
    } else if (mode() === "slider" && (drag || event.pointerType === "mouse")) {
      state.split = Math.min(Math.max(x / bounds.width, 0), 1);
      draw();
    }
  });
  stage.addEventListener("wheel", event => {
    event.preventDefault();
    const bounds = stage.getBoundingClientRect();
    zoom(2 ** (-event.deltaY / 200), event.clientX - bounds.left, event.clientY - bounds.top);
  }, { passive: false });
  stage.addEventListener("keydown", event => {
    const step = 0.05 * stage.clientWidth;
    const moves = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (event.key === " ") state.shown = !state.shown;
    else if (event.key === "+") middle(2);
    else if (event.key === "-") middle(0.5);
    else if (event.key in moves && state.scale > 1) {
      state.x += step * moves[event.key][0];
      state.y += step * moves[event.key][1];
      zoom(1, 0, 0);
    } else if (event.key in moves) state.split = Math.min(Math.max(state.split - 0.05 * moves[event.key][0], 0), 1);
    else return;
    event.preventDefault();
    draw();
  });
  find(".closer").addEventListener("click", () => middle(2));
  find(".farther").addEventListener("click", () => middle(0.5));
  find(".whole").addEventListener("click", () => middle(1 / 32));
  box.addEventListener("input", draw);
  Promise.all(figures.flatMap(figure => [...figure.querySelectorAll("img")]).map(image => image.decode().catch(() => {}))).then(draw);
}

document.querySelectorAll(".gallery").forEach(viewer);
