// One cursor line through all plots: the same moment everywhere.
const plots = [...document.querySelectorAll("svg.plot")], read = document.getElementById("time");
for (const plot of plots) {
  plot.addEventListener("mousemove", (e) => {
    const box = plot.getBoundingClientRect(), x = (e.clientX - box.left) / box.width * 1000;
    const from = +plot.dataset.from, to = +plot.dataset.to, t = from + (x - 74) / 912 * (to - from);
    for (const p of plots) {
      const a = +p.dataset.from, b = +p.dataset.to, c = p.querySelector(".cursor"), u = (t - a) / (b - a);
      c.style.opacity = u >= 0 && u <= 1 ? 1 : 0;
      c.setAttribute("x1", 74 + u * 912); c.setAttribute("x2", 74 + u * 912);
    }
    read.textContent = t >= from && t <= to ? "t = " + t.toFixed(2) + " s" : "";
  });
}
