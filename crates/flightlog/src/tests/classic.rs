//! A writer of the NetCDF classic format (CDF-1), enough for a log: one dimension, variables of doubles with units,
//! moves of the motors on a second dimension, whole numbers as attributes of the file.

pub struct File {
    rows: usize,
    variables: Vec<(String, String, usize, Vec<f64>)>,
    moves: usize,
    attributes: Vec<(String, i32)>,
}

impl File {
    pub fn new(rows: usize) -> Self {
        File { rows, variables: Vec::new(), moves: 0, attributes: Vec::new() }
    }

    pub fn variable(mut self, name: &str, units: &str, values: &[f64]) -> Self {
        self.variables.push((name.into(), units.into(), 0, values.to_vec()));
        self
    }

    pub fn with_moves(mut self, moves: &[(f64, f64)]) -> Self {
        self.moves = moves.len();
        self.variables.push(("gc_st_secs".into(), String::new(), 1, moves.iter().map(|m| m.0).collect()));
        self.variables.push(("gc_end_secs".into(), String::new(), 1, moves.iter().map(|m| m.1).collect()));
        self
    }

    pub fn attribute(mut self, name: &str, value: i32) -> Self {
        self.attributes.push((name.into(), value));
        self
    }

    pub fn bytes(&self) -> Vec<u8> {
        // The header's size does not depend on the offsets in it: written twice, the second time with the right ones.
        let header = self.header(0).len();
        let mut bytes = self.header(header);
        for (.., values) in &self.variables {
            values.iter().for_each(|value| bytes.extend(value.to_be_bytes()));
        }
        bytes
    }

    fn header(&self, data_from: usize) -> Vec<u8> {
        let mut out = b"CDF\x01".to_vec();
        word(&mut out, 0);
        word(&mut out, 0x0A);
        word(&mut out, 2);
        for (dimension, length) in [("row", self.rows), ("move", self.moves.max(1))] {
            text(&mut out, dimension);
            word(&mut out, length);
        }
        if self.attributes.is_empty() {
            word(&mut out, 0);
            word(&mut out, 0);
        } else {
            word(&mut out, 0x0C);
            word(&mut out, self.attributes.len());
            for (name, value) in &self.attributes {
                text(&mut out, name);
                word(&mut out, 4);
                word(&mut out, 1);
                out.extend(value.to_be_bytes());
            }
        }
        word(&mut out, 0x0B);
        word(&mut out, self.variables.len());
        let mut offset = data_from;
        for (name, units, dimension, values) in &self.variables {
            text(&mut out, name);
            word(&mut out, 1);
            word(&mut out, *dimension);
            word(&mut out, 0x0C);
            word(&mut out, 1);
            text(&mut out, "units");
            word(&mut out, 2);
            text(&mut out, units);
            word(&mut out, 6);
            word(&mut out, 8 * values.len());
            word(&mut out, offset);
            offset += 8 * values.len();
        }
        out
    }
}

fn word(out: &mut Vec<u8>, value: usize) {
    out.extend(u32::try_from(value).expect("a short file").to_be_bytes());
}

fn text(out: &mut Vec<u8>, text: &str) {
    word(out, text.len());
    out.extend(text.as_bytes());
    out.resize(out.len().next_multiple_of(4), 0);
}
