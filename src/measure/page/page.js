"use strict";
(() => {
  const { points, files } = JSON.parse(document.getElementById("pictures").textContent);
  const told = document.getElementById("told");

  document.getElementById("theme").addEventListener("click", () => {
    const root = document.documentElement;
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
  });

  // Titles become labels that appear at once, at the pointer.
  for (const title of document.querySelectorAll("svg.chart title")) {
    const part = title.parentElement, text = title.textContent;
    part.setAttribute("aria-label", text);
    title.remove();
    part.addEventListener("pointermove", event => {
      told.textContent = text;
      told.hidden = text === "";
      const left = event.pageX + 14, room = document.documentElement.clientWidth - told.offsetWidth - 8;
      told.style.left = Math.max(8, Math.min(left, room)) + "px";
      told.style.top = event.pageY + 14 + "px";
    });
    part.addEventListener("pointerleave", () => { told.hidden = true; });
  }

  const show = (mark, scrolls) => {
    const [picture, map, text] = points[mark.dataset.point];
    const viewer = mark.closest("section").querySelector(".viewer");
    viewer.hidden = false;
    viewer.querySelector(".told").textContent = text;
    for (const [name, file] of [["picture", picture], ["map", map]]) {
      const image = viewer.querySelector("img." + name);
      image.hidden = !files[file];
      if (files[file]) { image.src = files[file]; image.alt = name + " of " + text.split("\n")[0]; } else { image.removeAttribute("src"); }
    }
    if (scrolls) viewer.scrollIntoView({ block: "nearest" });
    viewer.querySelector("figure:last-child figcaption").textContent = map
      ? "its errors: each pixel's greatest channel difference, dark violet for none to yellow for the greatest of this picture"
      : "no pixel differs from a ray for every pixel";
  };
  for (const mark of document.querySelectorAll(".point[data-point]")) {
    mark.addEventListener("click", () => show(mark, true));
    mark.addEventListener("keydown", event => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); show(mark, true); } });
  }
  // The reference picture to begin with: the first point of each chart.
  for (const section of document.querySelectorAll("section")) {
    const first = section.querySelector(".point[data-point]");
    if (first) show(first, false);
  }
})();
