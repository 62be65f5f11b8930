//! Elements and attributes, indented and escaped.

/// Attributes of an element, in order; one without a value is left out.
pub type Attributes<'a> = &'a [(&'a str, Option<String>)];

/// A document that grows from its declaration down.
pub struct Document {
    text: String,
    open: Vec<String>,
}

impl Document {
    /// An empty document.
    pub fn new() -> Self {
        Document { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(), open: Vec::new() }
    }

    /// An element that holds others; closed by [`Document::close`].
    pub fn open(&mut self, name: &str, attributes: Attributes<'_>) {
        self.start(name, attributes);
        self.text.push_str(">\n");
        self.open.push(name.to_owned());
    }

    /// An element without content.
    pub fn leaf(&mut self, name: &str, attributes: Attributes<'_>) {
        self.start(name, attributes);
        self.text.push_str("/>\n");
    }

    /// Closes the innermost open element.
    pub fn close(&mut self) {
        let name = self.open.pop().expect("as many closed as opened");
        self.indent();
        self.text.push_str(&format!("</{name}>\n"));
    }

    /// The text, every element closed.
    pub fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    fn start(&mut self, name: &str, attributes: Attributes<'_>) {
        self.indent();
        self.text.push('<');
        self.text.push_str(name);
        for (key, value) in attributes {
            if let Some(value) = value {
                self.text.push_str(&format!(" {key}=\"{}\"", escape(value)));
            }
        }
    }

    fn indent(&mut self) {
        self.text.push_str(&"  ".repeat(self.open.len()));
    }
}

/// The text with the characters replaced that XML and HTML give a meaning.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// An attribute with a text.
pub fn text(value: impl Into<String>) -> Option<String> {
    Some(value.into())
}

/// An attribute with a number, in the shortest form that reads back as the same number.
pub fn number(value: f64) -> Option<String> {
    Some(format!("{value:?}").trim_end_matches(".0").to_owned())
}

/// An attribute that is there when true.
pub fn flag(value: bool) -> Option<String> {
    value.then(|| "true".to_owned())
}
