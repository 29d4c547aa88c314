const canvas = document.getElementById("timeline");
const told = document.getElementById("told");
const pen = canvas.getContext("2d");
const colours = { flight: "#c2410c", steady: "#1d6fb8", background: "#4d7c3a", "": "#52606d" };
const left = 110, line = 22, foot = 22;
const last = bars.reduce((most, bar) => Math.max(most, bar[3]), 1);
// A trace opens on its first ten milliseconds, seconds on all of them.
const opened = bars.some(bar => bar[4] >= 0) ? last : Math.min(last, 10000);
let from = 0, span = opened;

const x = us => left + (us - from) / span * (canvas.clientWidth - left);
const colour = bar => bar[4] < 0 ? colours[rows[bar[0]][1]]
  : bar[4] > 1 ? "#c81e1e" : `hsl(208 70% ${92 - 57 * Math.min(1, bar[4])}%)`;

function draw() {
  const wide = canvas.clientWidth, high = rows.length * line + foot, scale = devicePixelRatio || 1;
  canvas.style.height = high + "px";
  canvas.width = wide * scale;
  canvas.height = high * scale;
  pen.scale(scale, scale);
  pen.font = "12px system-ui, sans-serif";
  rows.forEach((row, n) => {
    pen.fillStyle = n % 2 ? "#f6f8fa" : "#ffffff";
    pen.fillRect(0, n * line, wide, line);
    pen.fillStyle = colours[row[1]];
    pen.fillText(row[0], 6, n * line + 15);
  });
  pen.save();
  pen.beginPath();
  pen.rect(left, 0, wide - left, high);
  pen.clip();
  for (const bar of bars) {
    if (bar[3] < from || bar[1] > from + span) continue;
    const top = bar[0] * line + 4;
    pen.fillStyle = colour(bar);
    pen.globalAlpha = 0.25;
    pen.fillRect(x(bar[1]), top, x(bar[2]) - x(bar[1]), line - 8);
    pen.globalAlpha = 1;
    pen.fillRect(x(bar[2]), top, Math.max(1, x(bar[3]) - x(bar[2])), line - 8);
  }
  const step = 10 ** Math.floor(Math.log10(span / 4));
  pen.fillStyle = "#52606d";
  for (let t = Math.ceil(from / step) * step; t < from + span; t += step * (span / step > 20 ? 5 : 1)) {
    pen.fillRect(x(t), 0, 0.5, high - foot);
    pen.fillText(t >= 1e6 ? (t / 1e6).toFixed(3) + " s" : t >= 1e4 ? (t / 1e3).toFixed(1) + " ms" : t + " µs", x(t) + 2, high - 6);
  }
  pen.restore();
}

function limit() {
  span = Math.min(Math.max(span, 20), last);
  from = Math.min(Math.max(from, 0), last - span);
  draw();
}

canvas.addEventListener("wheel", event => {
  event.preventDefault();
  const share = (event.offsetX - left) / (canvas.clientWidth - left), factor = event.deltaY > 0 ? 1.25 : 0.8;
  from += share * span * (1 - factor);
  span *= factor;
  limit();
}, { passive: false });
canvas.addEventListener("dblclick", () => { from = 0; span = last; limit(); });
canvas.addEventListener("mousemove", event => {
  if (event.buttons) {
    from -= event.movementX / (canvas.clientWidth - left) * span;
    limit();
  }
  const us = from + (event.offsetX - left) / (canvas.clientWidth - left) * span;
  const row = Math.floor(event.offsetY / line), near = span / 400;
  const bar = bars.find(b => b[0] === row && b[1] - near <= us && us <= b[3] + near);
  told.textContent = !bar ? "\u00a0" : bar[4] < 0
    ? `${rows[row][0]}: woken at ${bar[1]} µs, begins after ${bar[2] - bar[1]} µs, lasts ${bar[3] - bar[2]} µs`
    : `${rows[row][0]}: longest response ${(100 * bar[4]).toFixed(1)} % of the deadline`;
});
addEventListener("resize", draw);
draw();
