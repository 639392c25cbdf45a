// SPDX-License-Identifier: BSD-3-Clause
// Starts the 3D scene and marks the section that is being read in the table of contents.
(() => {
  const box = document.getElementById('scene-box');
  if (box) {
    box.classList.add('live');  // the canvas needs its size before the viewer asks for it
    let drawn = false;
    try { drawn = window.plumblineScene(box); } catch (error) { console.error(error); }
    box.classList.toggle('live', Boolean(drawn));
  }
  const links = new Map([...document.querySelectorAll('.toc a')].map((a) => [a.hash.slice(1), a]));
  const watcher = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      links.forEach((link) => link.classList.remove('here'));
      links.get(entry.target.id)?.classList.add('here');
    }
  }, {rootMargin: '-10% 0px -80% 0px'});
  links.forEach((_, id) => { const part = document.getElementById(id); if (part) watcher.observe(part); });
})();
