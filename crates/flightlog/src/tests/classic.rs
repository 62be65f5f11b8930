//! A writer of the NetCDF classic format (CDF-1), enough for a log: variables of doubles with units on a dimension for the
//! rows, moves of the motors on a second, other instruments on more; whole numbers and texts as attributes of the file.

pub struct File {
    rows: usize,
    variables: Vec<(String, String, Vec<usize>, Vec<f64>)>,
    dimensions: Vec<(String, usize)>,
    attributes: Vec<(String, Value)>,
}

enum Value {
    Whole(i32),
    Text(String),
}

impl File {
    pub fn new(rows: usize) -> Self {
        let dimensions = vec![("row".into(), rows), ("move".into(), 1)];
        File { rows, variables: Vec::new(), dimensions, attributes: Vec::new() }
    }

    pub fn variable(mut self, name: &str, units: &str, values: &[f64]) -> Self {
        assert_eq!(values.len(), self.rows);
        self.variables.push((name.into(), units.into(), vec![0], values.to_vec()));
        self
    }

    /// A variable on other dimensions, which are made where they are not there yet; on none, one number.
    pub fn variable_on(mut self, dimensions: &[(&str, usize)], name: &str, units: &str, values: &[f64]) -> Self {
        assert_eq!(values.len(), dimensions.iter().map(|(_, length)| length).product::<usize>());
        let of = dimensions.iter().map(|&(dimension, length)| {
            let found = self.dimensions.iter().position(|(known, _)| known == dimension);
            found.unwrap_or_else(|| {
                self.dimensions.push((dimension.into(), length));
                self.dimensions.len() - 1
            })
        });
        let of = of.collect();
        self.variables.push((name.into(), units.into(), of, values.to_vec()));
        self
    }

    pub fn with_moves(mut self, moves: &[(f64, f64)]) -> Self {
        self.dimensions[1].1 = moves.len().max(1);
        self.variables.push(("gc_st_secs".into(), String::new(), vec![1], moves.iter().map(|m| m.0).collect()));
        self.variables.push(("gc_end_secs".into(), String::new(), vec![1], moves.iter().map(|m| m.1).collect()));
        self
    }

    pub fn attribute(mut self, name: &str, value: i32) -> Self {
        self.attributes.push((name.into(), Value::Whole(value)));
        self
    }

    pub fn text(mut self, name: &str, value: &str) -> Self {
        self.attributes.push((name.into(), Value::Text(value.into())));
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
        word(&mut out, self.dimensions.len());
        for (dimension, length) in &self.dimensions {
            text(&mut out, dimension);
            word(&mut out, *length);
        }
        if self.attributes.is_empty() {
            word(&mut out, 0);
            word(&mut out, 0);
        } else {
            word(&mut out, 0x0C);
            word(&mut out, self.attributes.len());
            for (name, value) in &self.attributes {
                text(&mut out, name);
                match value {
                    Value::Whole(number) => {
                        word(&mut out, 4);
                        word(&mut out, 1);
                        out.extend(number.to_be_bytes());
                    }
                    Value::Text(characters) => {
                        word(&mut out, 2);
                        text(&mut out, characters);
                    }
                }
            }
        }
        word(&mut out, 0x0B);
        word(&mut out, self.variables.len());
        let mut offset = data_from;
        for (name, units, dimensions, values) in &self.variables {
            text(&mut out, name);
            word(&mut out, dimensions.len());
            dimensions.iter().for_each(|dimension| word(&mut out, *dimension));
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
