// What is wrong with the report on this screen, as a list of sentences. Called with the names of the
// figures that must be there.
function measure(figures) {
  const found = [];
  const width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > width) {
    found.push(`the page is ${document.documentElement.scrollWidth} px wide on ${width} px`);
  }
  // What moves under its own bar may be wider.
  for (const element of document.body.querySelectorAll("*:not(svg *)")) {
    const box = element.getBoundingClientRect();
    const scrolls = element.parentElement.closest(".scroll");
    if (!scrolls && box.right > width + 0.5) {
      found.push(`<${element.localName}> reaches to ${box.right} px: ${element.textContent.slice(0, 40)}`);
    }
  }
  for (const name of figures) {
    const figure = document.getElementById(name);
    if (!figure) {
      found.push(`figure ${name} is missing`);
      continue;
    }
    const frame = figure.getBoundingClientRect();
    if (frame.width < 300 || frame.height < 150) {
      found.push(`figure ${name} is ${frame.width} by ${frame.height} px`);
    }
    // Marks, that is neither background, grid, axes nor places to point at.
    const aside = ["#FFFFFF", "#DEE2E7", "#5B6470"];
    const marks = [...figure.querySelectorAll("polyline, polygon, circle, rect, line")].filter(
      (mark) =>
        !mark.closest("g") &&
        !aside.includes(mark.getAttribute("fill")) &&
        !aside.includes(mark.getAttribute("stroke")),
    );
    const points = marks.map((mark) => (mark.getAttribute("points") || "").trim().split(/\s+/).length);
    const drawn = points.reduce((sum, count) => sum + count, 0);
    if (drawn < 12) {
      found.push(`figure ${name} is empty: ${drawn} points`);
    }
    // Texts: within the figure, large enough, none upon another.
    const texts = [...figure.querySelectorAll("text")].filter((text) => text.textContent.trim());
    const boxes = texts.map((text) => text.getBoundingClientRect());
    if (texts.length < 6) {
      found.push(`figure ${name} has ${texts.length} texts`);
    }
    boxes.forEach((box, i) => {
      const text = texts[i].textContent.trim();
      if (box.left < frame.left - 1 || box.right > frame.right + 1 ||
          box.top < frame.top - 1 || box.bottom > frame.bottom + 1) {
        found.push(`figure ${name}: "${text}" is cut off`);
      }
      if (box.height < 9) {
        found.push(`figure ${name}: "${text}" is ${box.height} px high`);
      }
      for (let j = 0; j < i; j++) {
        const other = boxes[j];
        const across = Math.min(box.right, other.right) - Math.max(box.left, other.left);
        const down = Math.min(box.bottom, other.bottom) - Math.max(box.top, other.top);
        if (across > 1 && down > 3) {
          found.push(`figure ${name}: "${text}" lies upon "${texts[j].textContent.trim()}"`);
        }
      }
    });
  }
  return found;
}
