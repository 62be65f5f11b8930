//! Warnings that say the same of many runs or files, shortened for a reader at a terminal. Knows texts alone.

use std::collections::HashMap;

/// So many alike are printed of a long group.
const SHOWN: usize = 2;

/// So many alike stand whole: one for each hull of a campaign, or each dive of an afternoon, is worth reading.
const FEW: usize = 8;

/// The texts as they are printed: of many that differ in their numbers alone the first ones, and how many more there are.
pub(crate) fn shortened(texts: &[String]) -> Vec<String> {
    let forms: Vec<String> = texts.iter().map(|text| form(text)).collect();
    let mut all: HashMap<&str, usize> = HashMap::new();
    forms.iter().for_each(|form| *all.entry(form).or_default() += 1);
    let mut seen: HashMap<&str, usize> = HashMap::new();
    let mut lines = Vec::new();
    for (text, form) in texts.iter().zip(&forms) {
        let (all, seen) = (all[form.as_str()], seen.entry(form).or_default());
        *seen += 1;
        if all <= FEW || *seen <= SHOWN {
            lines.push(text.clone());
        }
        if all > FEW && *seen == SHOWN {
            lines.push(format!("and {} more like it, but for their numbers", all - SHOWN));
        }
    }
    lines
}

/// The text without its numbers and their signs.
fn form(text: &str) -> String {
    let mut form = String::new();
    for letter in text.chars().filter(|letter| !"-+".contains(*letter)) {
        let is_number = letter.is_ascii_digit() || letter == '.' && form.ends_with('#');
        match (is_number, form.ends_with('#')) {
            (true, true) => {}
            (true, false) => form.push('#'),
            (false, _) => form.push(letter),
        }
    }
    form
}

#[cfg(test)]
mod tests {
    use super::shortened;

    #[test]
    fn of_many_alike_the_first_stand_and_the_others_are_counted() {
        let of_run = |run: usize| format!("run R{run:05}: yaw_deg is {} in this file", 0.1 * run as f64 - 1.0);
        let mut texts: Vec<String> = (1..=40).map(of_run).collect();
        texts.insert(1, "no fit".to_owned());
        let [first, second] = [of_run(1), of_run(2)];
        let expected = [first.as_str(), "no fit", second.as_str(), "and 38 more like it, but for their numbers"];
        assert_eq!(shortened(&texts), expected);
    }

    #[test]
    fn few_alike_and_texts_that_differ_in_words_stand_whole() {
        let spikes = |file: &str, count: usize| format!("{file}.csv: {count} spikes");
        let mut few: Vec<String> = (0..8).map(|count| spikes("a", count)).collect();
        few.extend((0..8).map(|count| spikes("b", count)));
        assert_eq!(shortened(&few), few);
    }
}
