// SPDX-License-Identifier: BSD-3-Clause
// A click on a heading sorts its table by that column, numbers as numbers; a second click turns the order.
(() => {
  const keyOf = (row, column) => {
    const text = row.cells[column].textContent.trim();
    const number = parseFloat(text.replace(/^[^\d+\-\u2212.]+/, '').replace('\u2212', '-'));
    return row.cells[column].classList.contains('number') ? (Number.isNaN(number) ? Infinity : number) : text;
  };
  const compare = (a, b) => (typeof a === 'string' ? a.localeCompare(b, 'en', {numeric: true}) : a - b);
  document.querySelectorAll('.scroll table').forEach((table) => {
    const body = table.tBodies[0];
    if (!body || body.rows.length < 2) return;
    [...table.tHead.rows[0].cells].forEach((heading, column) => {
      heading.style.cursor = 'pointer';
      heading.title = 'Sort by this column';
      heading.addEventListener('click', () => {
        const sign = heading.dataset.order === 'up' ? -1 : 1;
        [...table.tHead.rows[0].cells].forEach((other) => delete other.dataset.order);
        heading.dataset.order = sign > 0 ? 'up' : 'down';
        const rows = [...body.rows].map((row) => [keyOf(row, column), row]);
        rows.sort(([a], [b]) => sign * compare(a, b));
        body.append(...rows.map(([, row]) => row));
      });
    });
  });
})();
