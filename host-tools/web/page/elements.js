// Elements of the page.

const $ = (id) => document.getElementById(id);

// An element with its properties and what it holds.
function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function table(header, rows, className = "") {
  const line = (cells, kind) => element("tr", {}, ...cells.map((cell) => element(kind, {}, cell)));
  const head = element("thead", {}, line(header, "th"));
  return element("table", { className }, head, element("tbody", {}, ...rows.map((row) => line(row, "td"))));
}

const scrolled = (inner) => element("div", { className: "scroll" }, inner);
