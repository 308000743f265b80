// Elements without ceremony. Text is always text: names in robot files are not trusted.
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

export function number(x, digits = 4) {
  if (x === null || x === undefined || Number.isNaN(x)) return "–";
  if (!Number.isFinite(x)) return x > 0 ? "∞" : "-∞";
  return x === 0                             ? "0" :
    Math.abs(x) >= 1e5 || Math.abs(x) < 1e-4 ? x.toExponential(digits - 2) :
                                               String(Number(x.toPrecision(digits)));
}

export function section(title, hint, open, fill) {
  const box = make("details", { open }, make("summary", {}, title + " ", make("small", {}, hint)));
  let filled = false;
  const once = () => {
    if (box.open && !filled) (filled = true), fill(box);
  };
  box.addEventListener("toggle", once);
  return { box, once };
}
