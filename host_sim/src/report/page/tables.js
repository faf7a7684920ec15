// Tables saved as CSV.

function cell(text, comma) {
  const number = comma && /^-?\d+(\.\d+)?$/.test(text) ? text.replace('.', ',') : text;
  return /[",;\n]/.test(number) ? `"${number.replace(/"/g, '""')}"` : number;
}

function csvOf(table, comma) {
  const rows = [];
  for (const row of table.rows) {
    const cells = Array.from(row.cells, (c) => cell(c.textContent.trim(), comma));
    rows.push(cells.join(comma ? ';' : ','));
  }
  return `${rows.join('\r\n')}\r\n`;
}

/** Gives each table of the page its button. */
export function addTableButtons() {
  const comma = document.getElementById('decimal-comma');
  for (const table of document.querySelectorAll('table[data-csv]')) {
    const button = document.createElement('button');
    button.type = 'button';
    button.className = 'save';
    button.textContent = `Save ${table.dataset.csv}.csv`;
    button.addEventListener('click', () => {
      const link = document.createElement('a');
      const text = csvOf(table, comma && comma.checked);
      link.href = URL.createObjectURL(new Blob([text], {type: 'text/csv'}));
      link.download = `${table.dataset.csv}.csv`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
    table.insertAdjacentElement('afterend', button);
  }
}
