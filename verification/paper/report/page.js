"use strict";
const all = (selector, within = document) => [...within.querySelectorAll(selector)];
const boxes = all("#filters input[type=checkbox]"), words = document.getElementById("words");
const items = all("[data-verdict]"), claims = items.filter((each) => each.matches("article")), parts = all("details.part");
const opened = new Set(parts.filter((each) => each.open));  // by the reader, and not by a search
const GREEK = {"α": "alpha", "γ": "gamma", "δ": "delta", "θ": "theta", "κ": "kappa", "λ": "lambda", "μ": "mu", "ν": "nu",
  "π": "pi", "ρ": "rho", "τ": "tau", "φ": "phi", "ϕ": "phi", "χ": "chi", "η": "eta", "ε": "epsilon", "∞": "infinity"};
function plain(text) {  // one spelling for a letter, however it is typed or set
  return text.normalize("NFKC").replace(/[α-ωϕ∞]/gu, (sign) => GREEK[sign] ?? sign).toLowerCase()
    .replace(/\bvarphi/g, "phi").replace(/\blam\b/g, "lambda").replace(/[\\{}$\s]+/g, " ").trim();
}
let texts = null;  // read when first searched
function text(item) {
  const set = all("math", item).map((each) => each.getAttribute("alttext")).join(" ");
  return plain(`${item.id} ${item.textContent} ${set}`);
}
function filter() {
  const wanted = new Set(boxes.filter((box) => box.checked).map((box) => box.value)), asked = plain(words.value).split(" ");
  const searching = words.value.trim() !== "";
  if (searching) texts ??= items.map(text);
  items.forEach((item, i) => {
    item.hidden = !wanted.has(item.dataset.verdict) || (searching && !asked.every((word) => texts[i].includes(word)));
  });
  for (const part of parts) {
    const some = part.querySelector("article:not([hidden])") !== null;
    part.hidden = !some;
    part.open = some && (searching || opened.has(part));
  }
  for (const group of all(".grade")) group.hidden = group.querySelector("li:not([hidden])") === null;
  const shown = claims.filter((claim) => !claim.hidden).length;
  document.getElementById("shown").textContent = `${shown} of ${claims.length} ${claims.length === 1 ? "claim" : "claims"} shown`;
  reach();
}
const form = document.getElementById("filters");
form.addEventListener("input", filter);
form.addEventListener("submit", (event) => event.preventDefault());
for (const part of parts) part.querySelector("summary").addEventListener("click", () => {
  part.open ? opened.delete(part) : opened.add(part);  // before it changes
});
document.getElementById("all").addEventListener("click", () => {
  const open = parts.some((part) => !part.hidden && !part.open);
  for (const part of parts) { part.open = open; open ? opened.add(part) : opened.delete(part); }
});
function arrive() {  // a link opens what it names, whatever is folded or left out
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (!target) return;
  if (target.closest("[hidden]")) {
    words.value = "";
    for (const box of boxes) box.checked = true;
    filter();
  }
  for (let each = target; each; each = each.parentElement) if (each.matches("details")) {
    each.open = true;
    if (each.matches(".part")) opened.add(each);
  }
  target.scrollIntoView();
}
addEventListener("hashchange", arrive);
const dialog = document.querySelector("dialog");
for (const button of all("button.picture")) button.addEventListener("click", () => {
  dialog.querySelector("figure").replaceChildren(button.querySelector("img").cloneNode(),
    button.parentElement.querySelector("figcaption").cloneNode(true));
  dialog.showModal();
});
dialog.addEventListener("click", () => dialog.close());
function reach(within = document) {  // what must be scrolled sideways can be with the keyboard; not measured while folded
  const wide = all(".quoted, dd, .erratum p", within).filter((each) => each.closest("details:not([open])") === null)
    .map((each) => [each, each.scrollWidth > each.clientWidth]);
  for (const [each, is] of wide) is ? each.setAttribute("tabindex", "0") : each.removeAttribute("tabindex");
}
addEventListener("resize", () => reach());
for (const each of all("details")) each.addEventListener("toggle", () => reach(each));
addEventListener("beforeprint", () => all("details").forEach((each) => each.open = true));
filter();
arrive();
