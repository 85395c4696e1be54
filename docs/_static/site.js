// Buttons that copy code, and a note above tables that are wider than the page.
for (const block of document.querySelectorAll("div.highlight")) {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "copy-code";
  button.textContent = "copy";
  button.onclick = async () => {
    await navigator.clipboard.writeText(block.querySelector("pre").textContent.trimEnd());
    button.textContent = "copied";
    setTimeout(() => { button.textContent = "copy"; }, 1500);
  };
  block.prepend(button);
}
const mark = () => {
  for (const box of document.querySelectorAll(".table-wrapper"))
    box.classList.toggle("wide", box.scrollWidth > box.clientWidth + 1);
};
addEventListener("resize", mark);
mark();
