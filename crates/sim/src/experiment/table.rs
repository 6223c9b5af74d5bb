//! Tables for people: Markdown, and LaTeX with the rules of booktabs.

/// A Markdown table, its columns aligned in the source too; those of numbers stand to the right.
///
/// ```
/// # use cohaul_sim::experiment::table::markdown_table;
/// let rows = [["flat", "61.2"], ["uphill", "7.5"]].map(|row| row.map(String::from).to_vec());
/// let text = markdown_table(&["terrain", "time s"], &rows);
/// assert_eq!(text, "\
/// | terrain | time s |
/// |:--------|-------:|
/// | flat    |   61.2 |
/// | uphill  |    7.5 |
/// ");
/// ```
pub fn markdown_table(header: &[&str], rows: &[Vec<String>]) -> String {
    let escape = |cell: &str| cell.replace('|', "\\|").replace('\n', " ");
    let header: Vec<String> = header.iter().map(|cell| escape(cell)).collect();
    let rows: Vec<Vec<String>> =
        rows.iter().map(|row| (0..header.len()).map(|column| escape(cell(row, column))).collect()).collect();
    let length = |text: &str| text.chars().count();
    let widths: Vec<usize> = (0..header.len())
        .map(|column| rows.iter().map(|row| length(&row[column])).fold(length(&header[column]).max(1), usize::max))
        .collect();
    let right: Vec<bool> = (0..header.len()).map(|column| is_of_numbers(&rows, column)).collect();
    let line = |cells: &[String]| {
        let cells = cells.iter().zip(&widths).zip(&right).map(|((text, &width), &right)| {
            let space = " ".repeat(width - length(text));
            if right { format!(" {space}{text} |") } else { format!(" {text}{space} |") }
        });
        format!("|{}\n", cells.collect::<String>())
    };
    let rule = widths.iter().zip(&right).map(|(&width, &right)| {
        let dashes = "-".repeat(width + 1);
        if right { format!("{dashes}:|") } else { format!(":{dashes}|") }
    });
    let mut text = line(&header);
    text.push_str(&format!("|{}\n", rule.collect::<String>()));
    text.extend(rows.iter().map(|row| line(row)));
    text
}

/// The same as a LaTeX `tabular`, for a document that uses the package booktabs.
///
/// ```
/// # use cohaul_sim::experiment::table::latex_table;
/// let text = latex_table(&["terrain", "time_s"], &[vec!["flat".into(), "61 ± 2".into()]]);
/// assert_eq!(text, "\
/// \\begin{tabular}{lr}
/// \\toprule
/// terrain & time\\_s \\\\
/// \\midrule
/// flat & 61 $\\pm$ 2 \\\\
/// \\bottomrule
/// \\end{tabular}
/// ");
/// ```
pub fn latex_table(header: &[&str], rows: &[Vec<String>]) -> String {
    let columns: String = (0..header.len()).map(|column| if is_of_numbers(rows, column) { 'r' } else { 'l' }).collect();
    let line = |cells: Vec<String>| format!("{} \\\\\n", cells.join(" & "));
    let mut text = format!("\\begin{{tabular}}{{{columns}}}\n\\toprule\n");
    text.push_str(&line(header.iter().map(|cell| latex(cell)).collect()));
    text.push_str("\\midrule\n");
    text.extend(rows.iter().map(|row| line((0..header.len()).map(|column| latex(cell(row, column))).collect())));
    text.push_str("\\bottomrule\n\\end{tabular}\n");
    text
}

/// A cell; empty where the row is too short.
fn cell(row: &[String], column: usize) -> &str {
    row.get(column).map_or("", String::as_str)
}

/// Whether a column is of numbers: every cell that is not empty or a dash starts with one.
fn is_of_numbers(rows: &[Vec<String>], column: usize) -> bool {
    let mut filled =
        rows.iter().map(|row| cell(row, column)).filter(|text| !["", "-", "–", "—"].contains(text)).peekable();
    let number = |text: &str| {
        let digits = text.trim_start_matches(['<', '>', '≤', '≥', '[', '(', '+', '-', '−', ' ']);
        digits.starts_with(|letter: char| letter.is_ascii_digit())
    };
    filled.peek().is_some() && filled.all(number)
}

/// Text as LaTeX prints it.
fn latex(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => escaped.extend(['\\', letter]),
            '\\' => escaped.push_str("\\textbackslash{}"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '<' => escaped.push_str("$<$"),
            '>' => escaped.push_str("$>$"),
            '±' => escaped.push_str("$\\pm$"),
            '×' => escaped.push_str("$\\times$"),
            '°' => escaped.push_str("$^\\circ$"),
            '·' => escaped.push_str("$\\cdot$"),
            '−' => escaped.push_str("$-$"),
            '≤' => escaped.push_str("$\\le$"),
            '≥' => escaped.push_str("$\\ge$"),
            'Δ' => escaped.push_str("$\\Delta$"),
            'μ' => escaped.push_str("$\\mu$"),
            '²' => escaped.push_str("$^2$"),
            '–' => escaped.push_str("--"),
            '—' => escaped.push_str("---"),
            '\n' => escaped.push(' '),
            other => escaped.push(other),
        }
    }
    escaped
}
