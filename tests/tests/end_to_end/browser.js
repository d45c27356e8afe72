"use strict";

// Uses the page as people do, by mouse and keyboard, and tells the page around it what didn't work.
addEventListener("load", async () => {
  const faults = [];
  const hold = (condition, what) => condition || faults.push(what);
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const settled = () => new Promise(done => setTimeout(done, 50));
  await Promise.all(all("figure img").map(image => ((image.loading = "eager"), image.decode().catch(() => faults.push(`no picture: ${image.alt}`)))));
  await settled();

  // Nothing is wider than the window but what scrolls by itself.
  const width = document.documentElement.clientWidth;
  hold(document.documentElement.scrollWidth <= width, `the page is ${document.documentElement.scrollWidth} wide in a window of ${width}`);
  for (const part of all("h1, h2, h3, p, .controls > *, .stage, figure, nav"))
    hold(part.getBoundingClientRect().right <= width + 1, `${part.tagName}.${part.className} sticks out: ${part.textContent.slice(0, 40)}`);

  // Columns of numbers rise after the first click and fall after the second; who can't click can press.
  for (const table of all("table")) {
    all("thead th", table).forEach((head, column) => {
      const button = head.querySelector("button");
      button.focus();
      hold(document.activeElement === button, "a head has no focus");
      for (const [order, sign] of [["ascending", 1], ["descending", -1]]) {
        button.click();
        hold(head.getAttribute("aria-sort") === order, `${button.textContent} isn't ${order}`);
        const values = [...table.tBodies[0].rows].map(row => row.cells[column]?.dataset.value).filter(value => value !== undefined).map(Number);
        hold(values.every((value, i) => i === 0 || sign * (value - values[i - 1]) >= 0), `${button.textContent}: ${values}`);
      }
    });
  }

  // Everything that is seen can be read aloud, too.
  for (const image of all("figure img")) hold(image.alt !== "", "a picture without a name");
  for (const control of all("button, select, input")) hold(control.textContent.trim() || control.ariaLabel || control.labels?.length, `${control.tagName} without a name`);
  for (const plot of all(".plot svg")) hold(plot.getAttribute("role") === "group" && plot.ariaLabel, "a plot without a name");
  for (const point of all(".plot circle[tabindex]")) hold(point.querySelector("title")?.textContent, "a point that doesn't tell its values");

  // Text stands out from its ground: 4.5 : 1.
  const luminance = color => {
    const [r, g, b] = color.match(/[\d.]+/g).map(Number).map(value => (value <= 10.31475 ? value / 3294.6 : ((value / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = element => {
    const color = element ? getComputedStyle(element).backgroundColor : "rgb(255, 255, 255)";
    return color.startsWith("rgb(") ? color : ground(element.parentElement);
  };
  for (const part of all("h1, h2, p, td, th button, .controls label, .bar span, a:not(.skip)")) {
    if (!part.textContent.trim()) continue;
    const [a, b] = [getComputedStyle(part).color, ground(part)].map(luminance);
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    hold(contrast >= 4.5, `${part.tagName} "${part.textContent.slice(0, 20)}" has a contrast of ${contrast.toFixed(1)}`);
  }

  // Two pictures: slider, flip, error, zoom, exposure, values under the pointer.
  hold(all(".gallery").every(gallery => all("figure", gallery).length < 2 || gallery.previousElementSibling.className === "viewer"), "a gallery without a viewer");
  for (const box of all(".viewer")) {
    const find = selector => box.querySelector(selector);
    const stage = find(".stage");
    const press = key => stage.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
    const style = selector => find(selector).style;
    stage.focus();
    hold(document.activeElement === stage, "the pictures have no focus");
    const before = style(".divider").left;
    press("ArrowRight");
    hold(parseFloat(style(".divider").left) > parseFloat(before), `the slider stays at ${before}`);
    press("+");
    hold(style(".over img").transform.includes("scale(2)") && style(".under img").transform === style(".over img").transform, "no zoom in step");
    press("-");
    const mode = value => find(`input[value=${value}]`).click();
    mode("flip");
    press(" ");
    hold(style(".over").visibility === "hidden", "space doesn't flip");
    press(" ");
    hold(style(".over").visibility === "visible", "space doesn't flip back");
    const shown = find(".over img").src;
    mode("error");
    hold(find(".over img").src !== shown, "no error is shown");
    if (find("input[value=map]")) {
      const error = find(".over img").src;
      mode("map");
      hold(![shown, error].includes(find(".over img").src), "no FLIP is shown");
    }
    mode("slider");
    find(".stops").value = 2;
    find(".stops").dispatchEvent(new Event("input", { bubbles: true }));
    hold(find("feFuncG").getAttribute("slope") === "4", "two stops aren't four times as bright");
    const place = stage.getBoundingClientRect();
    stage.dispatchEvent(new PointerEvent("pointermove", { clientX: place.left + place.width / 2, clientY: place.top + place.height / 2, pointerType: "mouse", bubbles: true }));
    hold(/pixel \d+, \d+: .*difference/.test(find("output").textContent), `told under the pointer: ${find("output").textContent}`);
  }

  const counts = `${width} wide, ${all("table").length} tables, ${all(".plot svg").length} plots, ${all(".viewer").length} viewers`;
  parent.postMessage([...faults, counts].join("\n"), "*");
});
