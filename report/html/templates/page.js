// SPDX-License-Identifier: BSD-3-Clause
// Starts the 3D scene, marks the section that is being read in the table of contents, sorts and copies
// tables, and saves plots and their data. All offline; nothing is loaded.
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

// Long names of files, calibrations and sequences may break after an underscore, a dash or a slash; short ones
// (T_SC0) stay whole.
document.querySelectorAll('th, td, .card .label, .verdict p').forEach((part) => {
  const long = /([\w./-]{24,})/;
  [...part.childNodes].filter((node) => node.nodeType === Node.TEXT_NODE && long.test(node.data)).forEach((node) => {
    const pieces = node.data.split(long).flatMap((words, i) => i % 2 ? words.split(/(?<=[_/-])/).flatMap((piece) => [piece, document.createElement('wbr')]) : [words]);
    node.replaceWith(...pieces);
  });
});

// Tables with a head: a click on a column sorts by it (again: the other way round), and a button copies
// the table as CSV.
(() => {
  const text = (cell) => cell.innerText.replace(/\s+/g, ' ').trim();
  const number = (words) => {
    const found = words.replace(/\u2212/g, '-').replace(/(\d)[ \u2009\u202f](?=\d{3}\b)/g, '$1').match(/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?/i);
    return found ? parseFloat(found[0]) : NaN;
  };
  const compare = (a, b) => {
    const x = number(a), y = number(b);
    if (!Number.isNaN(x) && !Number.isNaN(y)) return x - y;
    return a.localeCompare(b, 'en', {numeric: true});
  };
  const sort = (table, column, head) => {
    const down = head.getAttribute('aria-sort') === 'ascending';
    table.querySelectorAll('thead th').forEach((th) => th.removeAttribute('aria-sort'));
    head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
    const body = table.tBodies[0];
    const rows = [...body.rows].sort((a, b) => compare(text(a.cells[column]), text(b.cells[column])) * (down ? -1 : 1));
    body.append(...rows);
  };
  const csv = (table) => [...table.rows].map((row) => [...row.cells].map((cell) => {
    const value = text(cell);
    return /[",\n]/.test(value) ? `"${value.replace(/"/g, '""')}"` : value;
  }).join(',')).join('\n') + '\n';
  const copy = async (words) => {
    try { await navigator.clipboard.writeText(words); return true; } catch { /* an older way below */ }
    const area = document.createElement('textarea');
    area.value = words;
    document.body.append(area);
    area.select();
    const done = document.execCommand('copy');
    area.remove();
    return done;
  };
  document.querySelectorAll('main table').forEach((table) => {
    const head = table.tHead?.rows[0];
    const body = table.tBodies[0];
    if (!head || !body || body.rows.length < 3) return;
    const plain = [...table.rows].every((row) => row.cells.length === head.cells.length);
    if (plain) {
      [...head.cells].forEach((th, column) => {
        th.tabIndex = 0;
        th.classList.add('sorts');
        th.title = 'Sort by this column';
        th.addEventListener('click', () => sort(table, column, th));
        th.addEventListener('keydown', (event) => {
          if (event.key !== 'Enter' && event.key !== ' ') return;
          event.preventDefault();
          sort(table, column, th);
        });
      });
    }
    const button = document.createElement('button');
    button.type = 'button';
    button.className = 'tool copy-csv';
    button.textContent = 'Copy as CSV';
    button.addEventListener('click', async () => {
      const done = await copy(csv(table));
      button.textContent = done ? 'Copied' : 'Copying is not permitted';
      setTimeout(() => { button.textContent = 'Copy as CSV'; }, 1500);
    });
    (table.closest('.scroll') || table).after(button);
  });
})();

// Plots can be saved as they are, and what they draw as CSV.
(() => {
  const save = (name, type, text) => {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], {type}));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const button = (figure, name, words, act) => {
    const made = document.createElement('button');
    made.type = 'button';
    made.className = `tool ${name}`;
    made.textContent = words;
    made.addEventListener('click', act);
    figure.append(made);
  };
  const cell = (value) => /[",\n]/.test(value) ? `"${value.replace(/"/g, '""')}"` : value;
  const line = (values) => values.map((v) => cell(String(v))).join(',') + '\n';
  const digits = (value) => Number.isNaN(value) ? '' : Number(value.toPrecision(6));
  // The cells of a map have their values; everything else is read where it is drawn, to a tenth of a pixel or better.
  const cellRows = ({cells, home: [x0, x1, y0, y1]}) => {
    const at = (names, i, n, from, to) => names ? names[i] : digits(from + (i + 0.5) / n * (to - from));
    const rows = cells.values.map((value, i) => {
      const column = i % cells.columns, row = Math.floor(i / cells.columns);
      return [at(cells.x, column, cells.columns, x0, x1), at(cells.y, row, cells.rows, y1, y0), value ?? ''];
    });
    return line(['x', 'y', cells.label]) + rows.map(line).join('');
  };
  const drawnRows = (plot) => {
    const [x0, x1, y0, y1, px0, px1, py0, py1] = plot.home;
    const x = (p) => digits(plot.valueOf('x', x0 + (p - px0) * (x1 - x0) / (px1 - px0))), y = (p) => digits(plot.valueOf('y', y0 + (p - py0) * (y1 - y0) / (py1 - py0)));
    const rows = plot.shapes().flatMap(({shape, name, points}) => {
      const note = shape.querySelector('title')?.textContent || '';
      return (note ? points.slice(0, 1) : points).map(([a, b]) => [name, x(a), y(b), note]);
    });
    if (rows.length === 0) return '';
    const step = (axis, v0, v1, p0, p1) => {
      const tenth = Math.abs((v1 - v0) / (p1 - p0) / 20);
      return plot.isLog(axis) ? `${(100 * (10 ** tenth - 1)).toPrecision(2)} %` : tenth.toPrecision(2);
    };
    return `# as drawn: x to within ${step('x', x0, x1, px0, px1)}, y to within ${step('y', y0, y1, py0, py1)}\n` + line(['series', 'x', 'y', 'note']) + rows.map(line).join('');
  };
  document.querySelectorAll('main figure').forEach((figure, index) => {
    const svg = figure.querySelector(':scope > svg');
    if (!svg) return;
    const name = `${(figure.closest('section')?.id || 'figure')}-${index + 1}`;
    button(figure, 'save-svg', 'Save as SVG', () => {
      const copy = svg.cloneNode(true);
      copy.setAttribute('xmlns', 'http://www.w3.org/2000/svg');
      save(`${name}.svg`, 'image/svg+xml', new XMLSerializer().serializeToString(copy));
    });
    const plot = svg.plumbline;
    if (!plot || (!plot.cells && !svg.querySelector('polyline.data, path.pts, polygon.data'))) return;
    button(figure, 'save-csv', 'Save data as CSV', () => save(`${name}.csv`, 'text/csv', plot.cells ? cellRows(plot) : drawnRows(plot)));
  });
})();

// The list of contents folds where there is no room beside the page.
(() => {
  const list = document.querySelector('.toc details');
  if (!list) return;
  const narrow = matchMedia('(max-width: 900px)');
  const fold = () => { list.open = !narrow.matches; };
  narrow.addEventListener('change', fold);
  fold();
})();
