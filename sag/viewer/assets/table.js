// The table of figures: a line for each motion with the switch that shows it, the best figure of a column in bold.

const body = document.querySelector('#figures tbody');

// Columns that some motion of the window has a figure for.
function filledColumns(view) {
  const motions = [...view.rows.flatMap((row) => row.motions), ...(view.truth ? [view.truth] : [])];
  return content.columns.filter((column) => motions.some((motion) => Number.isFinite(motion.figures[column.key])));
}

function bestOf(column, motions) {
  const figures = motions.map((motion) => motion.figures[column.key]).filter(Number.isFinite);
  if (column.better === 'none' || figures.length < 2) return NaN;
  if (figures.every((figure) => written(column, figure) === written(column, figures[0]))) return NaN;
  return column.better === 'high' ? Math.max(...figures) : Math.min(...figures);
}

function written(column, figure) {
  return Number.isFinite(figure) ? figure.toFixed(column.digits) : '–';
}

function headings(columns, counted) {
  const line = element('tr', {}, element('th', { scope: 'col' }));
  if (counted) {
    const about = `Points of the scene within ${Math.round(1000 * content.touch)} mm of a bone in this frame`;
    line.append(element('th', { scope: 'col', title: about }, 'touch', element('small', {}, 'now')));
  }
  for (const column of columns) {
    line.append(element('th', { scope: 'col', title: column.about }, column.label, element('small', {}, column.unit || ' ')));
  }
  document.querySelector('#figures thead').replaceChildren(line);
}

// Fills the table for a row of a window; `change` is told which motion was switched.
function fillTable(view, motions, shown, change) {
  const columns = filledColumns(view);
  const listed = view.truth ? [...motions, view.truth] : motions;
  const counted = listed.some((motion) => motion.touched);
  headings(columns, counted);
  body.replaceChildren(...listed.map((motion, place) => {
    const box = element('input', { type: 'checkbox', checked: shown[place] });
    box.addEventListener('change', () => change(place));
    const swatch = element('span', { className: 'swatch', textContent: motion.mark });
    swatch.style.setProperty('--own', motion.colour);
    const line = element('tr', {}, element('th', { scope: 'row' }, element('label', {}, box, swatch, element('span', { className: 'label', textContent: motion.label }))));
    if (counted) line.append(element('td', { className: 'now' }));
    for (const column of columns) {
      const figure = motion.figures[column.key];
      const best = motion !== view.truth && figure === bestOf(column, motions);
      line.append(element('td', { className: best ? 'best' : '' }, written(column, figure)));
    }
    return line;
  }));
  fillMeanings(columns, counted);
}

function fillMeanings(columns, counted) {
  const touch = { label: 'touch now', about: `Points of the scene within ${Math.round(1000 * content.touch)} mm of a bone` };
  const meant = [...(counted ? [touch] : []), ...columns];
  document.getElementById('meanings').replaceChildren(...meant.flatMap((column) =>
    [element('dt', {}, column.label), element('dd', {}, column.about + (column.unit ? `, ${column.unit}` : ''))]));
}

// Shows how many points each motion touches in a frame, and which motions are switched on.
function updateTable(listed, shown, frame) {
  [...body.rows].forEach((line, place) => {
    line.querySelector('input').checked = shown[place];
    line.classList.toggle('off', !shown[place]);
    const cell = line.querySelector('.now');
    if (!cell) return;
    const count = listed[place].touched ? listed[place].touched[frame] : 0;
    cell.textContent = count;
    cell.classList.toggle('touching', count > 0);
  });
}

// Draws for each motion that is shown a lane in which frames that touch the scene stand out.
function drawLanes(canvas, listed, shown) {
  const lanes = listed.filter((motion, place) => shown[place] && motion.touched);
  canvas.hidden = !lanes.length;
  const [width, lane] = [Math.max(1, canvas.clientWidth * 2), 10];
  Object.assign(canvas, { width, height: Math.max(1, lane * lanes.length) });
  canvas.style.height = `${(lane * lanes.length) / 2}px`;
  const pen = canvas.getContext('2d');
  lanes.forEach((motion, place) => {
    pen.globalAlpha = 0.3;
    pen.fillStyle = motion.colour;
    pen.fillRect(0, lane * place + 2, width, lane - 4);
    pen.fillStyle = TOUCH_COLOUR;
    motion.touched.forEach((count, frame) => {
      if (!count) return;
      pen.globalAlpha = Math.min(1, 0.3 + count / 80);
      pen.fillRect((frame * width) / motion.frames, lane * place + 1, width / motion.frames + 0.5, lane - 2);
    });
  });
}
