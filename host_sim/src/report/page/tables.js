// Tables saved as CSV.

function cell(element, comma) {
  const text = element.textContent.trim();
  const isNumber = comma && element.matches('td.n, table.numbers td');
  const words = isNumber ? text.replace(/(\d)\.(\d)/g, '$1,$2') : text;
  return /[",;\n]/.test(words) ? `"${words.replace(/"/g, '""')}"` : words;
}

function csvOf(table, comma) {
  const rows = [];
  for (const row of table.rows) {
    rows.push(Array.from(row.cells, (c) => cell(c, comma)).join(comma ? ';' : ','));
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
