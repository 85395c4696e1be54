for (const box of document.querySelectorAll(".zoom")) {
  const svg = box.querySelector("svg"), [left, top, width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
  let x = left, y = top, part = 1, held = null;
  const show = () => {
    x = Math.min(Math.max(x, left), left + width * (1 - part));
    y = Math.min(Math.max(y, top), top + height * (1 - part));
    svg.setAttribute("viewBox", [x, y, width * part, height * part].join(" "));
    svg.style.touchAction = part < 1 ? "none" : "auto";
  };
  const place = event => {
    const area = svg.getBoundingClientRect();
    return [(event.clientX - area.left) / area.width, (event.clientY - area.top) / area.height];
  };
  const zoom = (factor, [u, v] = [.5, .5]) => {
    const before = part;
    part = Math.min(Math.max(part * factor, .02), 1);
    x += u * width * (before - part);
    y += v * height * (before - part);
    show();
  };
  const move = (u, v) => { x += u * width * part; y += v * height * part; show(); };
  const keys = { "+": () => zoom(.5), "-": () => zoom(2), 0: () => zoom(1e9), ArrowLeft: () => move(-.2, 0),
    ArrowRight: () => move(.2, 0), ArrowUp: () => move(0, -.2), ArrowDown: () => move(0, .2) };
  for (const button of box.querySelectorAll("button")) button.onclick = () => keys[button.value]();
  box.onkeydown = event => {
    if (!keys[event.key] || event.ctrlKey || (part === 1 && event.key.startsWith("Arrow"))) return;
    event.preventDefault();
    keys[event.key]();
  };
  svg.ondblclick = event => zoom(event.shiftKey ? 2 : .5, place(event));
  svg.onpointerdown = event => { if (part < 1) { held = place(event); svg.setPointerCapture(event.pointerId); } };
  svg.onpointermove = event => { if (held) { const now = place(event); move(held[0] - now[0], held[1] - now[1]); held = now; } };
  svg.onpointerup = svg.onpointercancel = () => { held = null; };
}
for (const box of document.querySelectorAll(".motion")) {
  const frames = JSON.parse(box.dataset.frames), slider = box.querySelector("input");
  const bodies = box.querySelectorAll(".body"), pins = box.querySelectorAll(".pin"), outlines = box.querySelectorAll(".outline");
  const show = () => {
    const k = slider.value, pose = frames.bodies[k], places = frames.joints[k], numbers = frames.numbers[k];
    bodies.forEach((body, n) => body.setAttribute("transform", `translate(${pose[3 * n]} ${pose[3 * n + 1]}) rotate(${pose[3 * n + 2]})`));
    outlines.forEach(line => line.setAttribute("transform", `rotate(${pose[3 * line.dataset.body + 2]})`));
    pins.forEach((pin, n) => {
      const [x, y, u, v] = places.slice(4 * n, 4 * n + 4), arrow = pin.querySelector("line");
      pin.setAttribute("transform", `translate(${x} ${y})`);
      arrow.setAttribute("x2", u);
      arrow.setAttribute("y2", v);
    });
    const force = number => number < 1e4 ? `${number} N` : `${(number / 1e3).toPrecision(3)} kN`;
    const texts = numbers.map((number, n) => `${frames.names[n]} ${n ? force(number) : `${number} degrees`}`);
    box.querySelector("output").textContent = texts.join(", ");
  };
  slider.oninput = show;
  show();
}
const mark = () => {
  for (const box of document.querySelectorAll(".scroll")) box.classList.toggle("wide", box.scrollWidth > box.clientWidth + 1);
};
addEventListener("resize", mark);
document.addEventListener("toggle", mark, true);
mark();
