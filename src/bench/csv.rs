//! Tables of comma-separated values with one line per row. Cells stay text: the columns of a table of samples
//! depend on the passes, which the derived readers of serde cannot flatten from CSV.

/// A parsed table, whose cells are text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// Names of the columns, from the header.
    pub columns: Vec<String>,
    /// Rows, each as long as the header.
    pub rows: Vec<Vec<String>>,
    /// Bytes up to the end of the last complete line; the rest was cut off while it was written.
    pub whole_bytes: usize,
}

/// Reason why a text is no table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct CsvError {
    /// Line of the text, from 1.
    pub line: usize,
    /// Message about the mistake.
    pub message: String,
}

/// Formats cells as one line with its line break. Line breaks inside cells become spaces, so that a row
/// is always one line and a row that was cut off is detected.
pub fn line<T: AsRef<str>>(cells: impl IntoIterator<Item = T>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let cells = cells.into_iter();
    let cells = cells.map(|cell| cell.as_ref().replace(['\r', '\n'], " "));
    writer.write_record(cells).expect("memory takes all");
    let bytes = writer.into_inner().expect("memory takes all");
    String::from_utf8(bytes).expect("cells are text")
}

/// Parses a table. A last line without a line break is left out: its writer was stopped.
///
/// # Errors
/// No header, a row that is shorter or longer than it, or a quote that does not close.
pub fn parse(text: &str) -> Result<Table, CsvError> {
    let whole_bytes = text.rfind('\n').map_or(0, |i| i + 1);
    if whole_bytes == 0 {
        let message = if text.is_empty() {
            "there is no header; the file is empty"
        } else {
            "the header is cut off: it has no line break"
        };
        return Err(CsvError {
            line: 1,
            message: message.to_owned(),
        });
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(&text.as_bytes()[..whole_bytes]);
    let mut rows: Vec<Vec<String>> = Vec::new();
    for record in reader.records() {
        let line = |at: Option<&csv::Position>| at.map_or(1, |at| at.line() as usize);
        let record = record.map_err(|error| CsvError {
            line: line(error.position()),
            message: error.to_string(),
        })?;
        let columns = rows.first().map_or(record.len(), Vec::len);
        let message = if record.iter().any(|cell| cell.contains('\n')) {
            "a quote does not close".to_owned()
        } else if record.len() != columns {
            let cells = record.len();
            format!("{cells} cells where the header has {columns} columns")
        } else {
            rows.push(record.iter().map(str::to_owned).collect());
            continue;
        };
        let line = line(record.position());
        return Err(CsvError { line, message });
    }
    Ok(Table {
        columns: rows.remove(0),
        rows,
        whole_bytes,
    })
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
