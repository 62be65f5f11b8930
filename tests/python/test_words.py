"""The words of pages, messages, help texts and reports: standard terms, short sentences.

A page, a template or a string of a program that uses an expression of the project's own making fails here, with its place. So
does a page of the documentation with a sentence that is too long to follow. Code, tables and headings are not prose."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "wheel/README.md", *sorted((ROOT / "docs").rglob("*.md")), ROOT / "benches/notes.md"]
FOLDERS = [ROOT / folder for folder in ("src", "tank", "fmu", "crates", "xtask", "archive", "modelDescription")]
FORBIDDEN = re.compile(
    r"foretell|does not tell|cannot tell|\bis told\b|\btold by\b|\bsaid of\b|looked at in passing|never saw|nobody has seen|nobody steers"
    r"|stand-in|in the race|\brunners?\b|\bleaps?\b|thinned out|hulls that yield|without a name|furthest for its depth"
    r"|longest in the water|intervals that hold|goes with|\bmended\b",
    re.IGNORECASE,
)
MEAN_WORDS, MOST_WORDS = 18, 45


def is_test(path: Path) -> bool:
    return bool({"tests", "benches", "target", "examples"} & set(path.relative_to(ROOT).parts)) or path.stem == "tests"


def strings_of(source: str) -> list[tuple[int, str]]:
    """Line and text of each string of a Rust source; comments and what follows `#[cfg(test)]` are left out."""
    source = source.partition("#[cfg(test)]")[0]
    token = re.compile(r'//[^\n]*|/\*.*?\*/|r(#+)"(.*?)"\1|"((?:[^"\\]|\\.)*)"|\'(?:[^\'\\]|\\.)\'', re.DOTALL)
    found = []
    for match in token.finditer(source):
        text = match[2] if match[2] is not None else match[3]
        if text is not None:
            found.append((source.count("\n", 0, match.start()) + 1, text))
    return found


def help_texts_of(source: str) -> list[tuple[int, str]]:
    """Doc comments of a command line's fields: clap prints them as help."""
    if "clap" not in source:
        return []
    return [(n, line) for n, line in enumerate(source.splitlines(), 1) if line.strip().startswith("///")]


def prose_of(page: str) -> list[str]:
    """The paragraphs of a page without code, tables and headings; each item of a list is one."""
    page = re.sub(r"```.*?```|<!--.*?-->", "", page, flags=re.DOTALL)
    paragraphs, current, begins = [], [], True
    for line in [*page.splitlines(), ""]:
        text = line.strip()
        item = re.match(r"([-*]|\d+\.) ", text)
        is_code = line.startswith("    ") and begins
        if not text or is_code or item or text[0] in "#|!":
            if current:
                paragraphs.append(" ".join(current))
            current = []
        if text and not is_code and text[0] not in "#|!":
            current.append(text[item.end() :] if item else text)
        begins = not text or is_code or (bool(text) and text[0] in "#|!")
    return paragraphs


def sentences_of(paragraph: str) -> list[str]:
    plain = re.sub(r"\]\([^)]*\)", "]", re.sub(r"`[^`]*`", "X", paragraph))
    return [part for part in re.split(r"(?<=[.!?])\s+(?=[A-Z*\[(\"0-9])", plain) if part.strip()]


def words_of(sentence: str) -> int:
    return len(re.findall(r"[A-Za-z0-9]\S*", sentence))


def test_sentences_are_counted():
    page = "# Head\n\nOne two three. Four `a b c` six\nseven.\n\n    code here\n\n- An item of five words. `x` is two.\n\n| a | table |\n"
    assert prose_of(page) == ["One two three. Four `a b c` six seven.", "An item of five words. `x` is two."]
    assert [words_of(s) for s in sentences_of("One two three. Four `a b c` six seven.")] == [3, 4]


def test_strings_are_found_and_comments_are_not():
    source = 'let a = "one \\" two"; // "three"\nlet b = r#"four "five""#; let c = \'"\'; "six"\n#[cfg(test)]\nmod t { "seven" }'
    assert [text for _, text in strings_of(source)] == ['one \\" two', 'four "five"', "six"]


def test_pages_messages_help_and_reports_use_standard_terms():
    found = []
    for page in PAGES:
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            found += [f"{page.relative_to(ROOT)}:{number}: {line.strip()}"] if FORBIDDEN.search(line) else []
    for folder in filter(Path.is_dir, FOLDERS):
        for path in sorted(folder.rglob("*")):
            if is_test(path) or path.suffix not in {".rs", ".html", ".xml", ".css"}:
                continue
            text = path.read_text(encoding="utf-8")
            lines = strings_of(text) + help_texts_of(text) if path.suffix == ".rs" else list(enumerate(text.splitlines(), 1))
            found += [f"{path.relative_to(ROOT)}:{number}: {line}" for number, line in lines if FORBIDDEN.search(line)]
    assert found == [], "\n".join(found)


def test_sentences_of_the_pages_are_short():
    lengths, long = [], []
    for page in PAGES:
        for sentence in (s for paragraph in prose_of(page.read_text(encoding="utf-8")) for s in sentences_of(paragraph)):
            lengths.append(words_of(sentence))
            if lengths[-1] > MOST_WORDS:
                long.append(f"{page.relative_to(ROOT)}: {lengths[-1]} words: {sentence[:80]} ...")
    mean = sum(lengths) / len(lengths)
    print(f"{len(lengths)} sentences, mean {mean:.1f} words, longest {max(lengths)}")
    assert mean <= MEAN_WORDS and long == [], f"mean {mean:.1f}\n" + "\n".join(long)


def test_each_page_says_its_kind():
    kinds = {"how-to": "# How to ", "reference": "# Reference: ", "theory": "# Theory: ", "evidence": "# Evidence: "}
    wrong = []
    for page in (ROOT / "docs").rglob("*.md"):
        kind = page.parent.name
        if kind in kinds and not page.read_text(encoding="utf-8").startswith(kinds[kind]):
            wrong.append(str(page.relative_to(ROOT)))
    assert wrong == []
