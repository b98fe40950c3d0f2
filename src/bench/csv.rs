//! Comma-separated values as RFC 4180 has them: one header, one line per row.

use std::fmt;

/// A table as read: cells are text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// The header.
    pub columns: Vec<String>,
    /// Rows as long as the header.
    pub rows: Vec<Vec<String>>,
    /// Bytes up to the end of the last complete line; what follows was cut off while it was
    /// written.
    pub whole_bytes: usize,
}

/// Why a text is no table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CsvError {
    /// Line of the text, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for CsvError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

/// Cells as one line with its line break. Line breaks inside cells become spaces, so that a row
/// is always one line and a torn one is seen.
pub fn line<T: AsRef<str>>(cells: impl IntoIterator<Item = T>) -> String {
    let quoted: Vec<String> = cells.into_iter().map(|cell| quote(cell.as_ref())).collect();
    quoted.join(",") + "\n"
}

fn quote(cell: &str) -> String {
    let cell = cell.replace(['\r', '\n'], " ");
    if cell.contains([',', '"']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell
    }
}

/// Reads a table. A last line without a line break is left out: its writer was stopped.
///
/// # Errors
/// No header, a row that is shorter or longer than it, or a quote that does not close.
pub fn parse(text: &str) -> Result<Table, CsvError> {
    let whole_bytes = text.rfind('\n').map_or(0, |i| i + 1);
    let mut lines = text[..whole_bytes].lines().enumerate();
    let Some((_, header)) = lines.next() else {
        return Err(CsvError {
            line: 1,
            message: if text.is_empty() {
                "there is no header; the file is empty".to_owned()
            } else {
                "the header is cut off: it has no line break".to_owned()
            },
        });
    };
    let split = |index: usize, text: &str| {
        let line = index + 1;
        cells(text).map_err(|message| CsvError { line, message })
    };
    let columns = split(0, header.trim_start_matches('\u{feff}'))?;
    let mut rows = Vec::new();
    for (index, text) in lines.filter(|(_, text)| !text.is_empty()) {
        let row = split(index, text)?;
        if row.len() != columns.len() {
            let message = format!(
                "{} cells where the header has {} columns",
                row.len(),
                columns.len()
            );
            let line = index + 1;
            return Err(CsvError { line, message });
        }
        rows.push(row);
    }
    Ok(Table {
        columns,
        rows,
        whole_bytes,
    })
}

fn cells(line: &str) -> Result<Vec<String>, String> {
    let mut cells = vec![String::new()];
    let mut chars = line.chars().peekable();
    let mut quoted = false;
    while let Some(c) = chars.next() {
        let cell = cells.last_mut().expect("never empty");
        match c {
            '"' if quoted && chars.peek() == Some(&'"') => {
                chars.next();
                cell.push('"');
            }
            '"' if quoted => quoted = false,
            '"' if cell.is_empty() => quoted = true,
            ',' if !quoted => cells.push(String::new()),
            c => cell.push(c),
        }
    }
    if quoted {
        Err("a quote does not close".to_owned())
    } else {
        Ok(cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let cells = ["plain", "", "a, b", "say \"so\"", "two\nlines"];
        let text = line(["a", "b", "c", "d", "e"]) + line(cells).as_str();
        let table = parse(&text).expect("a table");
        assert_eq!(table.columns, ["a", "b", "c", "d", "e"]);
        assert_eq!(
            table.rows,
            [["plain", "", "a, b", "say \"so\"", "two lines"]]
        );
        assert_eq!(table.whole_bytes, text.len());
    }

    #[test]
    fn a_torn_last_line_is_left_out_and_other_faults_are_named() {
        let table = parse("a,b\n1,2\n3,").expect("a table");
        assert_eq!((table.rows.len(), table.whole_bytes), (1, 8));
        let says = |text: &str| parse(text).expect_err(text).to_string();
        assert!(says("").contains("empty"));
        assert_eq!(
            says("a,b"),
            "line 1: the header is cut off: it has no line break"
        );
        assert_eq!(
            says("a,b\n1\n"),
            "line 2: 1 cells where the header has 2 columns"
        );
        assert_eq!(says("a\n\"1\n"), "line 2: a quote does not close");
    }
}
