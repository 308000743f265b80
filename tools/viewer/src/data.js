// What the command wrote into the page: a head in JSON, and numbers in base64 that it refers to.

export function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** @returns a function that gives the typed array that {at, n, as} refers to */
export function reader(bytes) {
  const kinds = { f32: Float32Array, u16: Uint16Array, u32: Uint32Array };
  return ({ at, n, as, lower, step }) => {
    const start = bytes.byteOffset + at;
    if (as === "q16") return columns(new Uint16Array(bytes.buffer, start), n, lower, step);
    return new kinds[as](bytes.buffer, start, n);
  };
}

// rows of n numbers in all; columns of step 0 are not stored
function columns(stored, n, lower, step) {
  const out = new Float32Array(n);
  for (let k = 0, from = 0, c = 0; k < n; ++k, c = c + 1 === lower.length ? 0 : c + 1)
    out[k] = step[c] > 0 ? lower[c] + step[c] * stored[from++] : lower[c];
  return out;
}

export function readPage() {
  const head = document.getElementById("dyn-head");
  if (!head) return null;
  const bytes = bytesOf(document.getElementById("dyn-numbers").textContent);
  const page = { head: JSON.parse(head.textContent), read: reader(bytes) };
  const { beside } = page.head; // a second page's head, and where its numbers begin
  return beside ? { ...page, readBeside: reader(bytes.subarray(beside.at)) } : page;
}
