// What the user does.

$("choose").onchange = () => {
  add($("choose").files);
  $("choose").value = "";
};
document.body.ondragover = (event) => {
  event.preventDefault();
  $("drop").classList.add("over");
};
document.body.ondragleave = () => $("drop").classList.remove("over");
document.body.ondrop = (event) => {
  event.preventDefault();
  $("drop").classList.remove("over");
  add(event.dataTransfer.files);
};
$("mapping").onchange = look;
$("form").onsubmit = (event) => {
  event.preventDefault();
  fit();
};
$("cancel").onclick = () => cancel.abort(new Error("cancelled"));
command.catch(() => say("error", "This browser cannot run the page: expected Chrome 103, Edge 103, Firefox 113, Safari 16.4 "
  + "or later."));
