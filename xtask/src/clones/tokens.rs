//! A Rust source as a sequence of tokens.

use std::hash::{DefaultHasher, Hash, Hasher};

/// A token, known by its hash, and the line it stands in.
#[derive(Debug, Clone, Copy)]
pub struct Token {
    pub hash: u64,
    pub line: usize,
}

/// The tokens of a source without comments and without modules of tests.
pub fn tokens(text: &str) -> Vec<Token> {
    let words = words(text);
    let mut tokens = Vec::with_capacity(words.len());
    let mut at = 0;
    while at < words.len() {
        if starts_tests(&words[at..]) {
            at += length_of_block(&words[at..]);
            continue;
        }
        let (word, line) = words[at];
        let mut hasher = DefaultHasher::new();
        word.hash(&mut hasher);
        tokens.push(Token { hash: hasher.finish(), line });
        at += 1;
    }
    tokens
}

/// Whether a module that is built for tests only begins here.
fn starts_tests(words: &[(&str, usize)]) -> bool {
    let wanted = ["#", "[", "cfg", "(", "test", ")", "]", "mod"];
    words.len() > wanted.len() && wanted.iter().zip(words).all(|(wanted, (word, _))| wanted == word)
}

/// How many tokens there are to the end of the next block, or to the next semicolon where that comes first.
fn length_of_block(words: &[(&str, usize)]) -> usize {
    let mut depth = 0_usize;
    for (number, (word, _)) in words.iter().enumerate() {
        match *word {
            "{" => depth += 1,
            "}" if depth == 1 => return number + 1,
            "}" => depth = depth.saturating_sub(1),
            ";" if depth == 0 => return number + 1,
            _ => {}
        }
    }
    words.len()
}

/// Words, numbers, whole strings and single signs, each with its line from 1.
fn words(text: &str) -> Vec<(&str, usize)> {
    let mut words = Vec::new();
    let (mut rest, mut line) = (text, 1);
    while let Some(first) = rest.chars().next() {
        let length = length(rest, first);
        let (word, after) = rest.split_at(length);
        if !first.is_whitespace() && !word.starts_with("//") && !word.starts_with("/*") {
            words.push((word, line));
        }
        line += word.matches('\n').count();
        rest = after;
    }
    words
}

/// The length of the token, comment or blank that begins the text \[bytes\].
fn length(text: &str, first: char) -> usize {
    let until = |end: &str, from: usize| text[from..].find(end).map_or(text.len(), |place| from + place + end.len());
    let run = |is_part: fn(char) -> bool| text.find(|c| !is_part(c)).unwrap_or(text.len());
    if text.starts_with("//") {
        return text.find('\n').unwrap_or(text.len());
    }
    if text.starts_with("/*") {
        return until("*/", 2);
    }
    if let Some(raw) = raw_string(text) {
        return raw;
    }
    match first {
        '"' => string(text),
        '\'' => character(text),
        c if c.is_whitespace() => run(char::is_whitespace),
        c if c.is_alphanumeric() || c == '_' => run(|c| c.is_alphanumeric() || c == '_'),
        c => c.len_utf8(),
    }
}

/// The length of `r"..."` or `r#"..."#`; none where no such string begins.
fn raw_string(text: &str) -> Option<usize> {
    let inner = text.strip_prefix('r')?;
    let n_signs = inner.find(|c| c != '#')?;
    inner[n_signs..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(n_signs));
    let from = n_signs + 2;
    Some(text[from..].find(&end).map_or(text.len(), |place| from + place + end.len()))
}

/// The length of a string in quotes.
fn string(text: &str) -> usize {
    let mut escaped = false;
    for (place, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return place + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

/// The length of a character in quotes, or of the sign that begins the name of a lifetime.
fn character(text: &str) -> usize {
    let mut inner = text.char_indices().skip(1);
    match (inner.next(), inner.next()) {
        (Some((_, '\\')), Some((place, c))) => {
            let from = place + c.len_utf8();
            text[from..].find('\'').map_or(text.len(), |end| from + end + 1)
        }
        (Some(_), Some((place, '\''))) => place + 1,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_is_taken_apart() {
        let text = "let a: &'x str = \"q \\\" { // no\"; // remark\n/* more\n */ f('}', '\\'', r#\"\"\"#, 1.5);";
        let found: Vec<&str> = words(text).iter().map(|(word, _)| *word).collect();
        let wanted = ["let", "a", ":", "&", "'", "x", "str", "=", "\"q \\\" { // no\"", ";", "f", "(", "'}'", ","];
        assert_eq!(found[..wanted.len()], wanted);
        assert_eq!(found[wanted.len()..], ["'\\''", ",", "r#\"\"\"#", ",", "1", ".", "5", ")", ";"]);
        assert_eq!(words(text).last().unwrap().1, 3);
    }
}
