//! Finds what a Rust source defines: types, functions, modules, fields and variants. A reader of lines, no parser: it
//! relies on the formatting that `cargo fmt` enforces.

/// What is defined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A type, trait, module, constant or static.
    Item,
    /// A function.
    Function,
    /// A field of a struct or of a variant.
    Field,
    /// A variant of an enum.
    Variant,
}

/// One definition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Definition<'a> {
    /// What it is.
    pub kind: Kind,
    /// Its name.
    pub name: &'a str,
    /// Its line, from 1.
    pub line: usize,
}

const KEYWORDS: [&str; 9] = ["struct", "enum", "union", "trait", "type", "fn", "mod", "const", "static"];

/// All definitions of a source, in order.
pub fn definitions(source: &str) -> Vec<Definition<'_>> {
    let mut found = Vec::new();
    // The indentation of the struct or enum whose body this is, and whether it is an enum.
    let mut body: Option<(usize, bool)> = None;
    for (index, line) in source.lines().enumerate() {
        let line_number = index + 1;
        let code = code_of(line);
        let indentation = line.len() - line.trim_start().len();
        if let Some((keyword, name)) = item(code) {
            let is_enum = keyword == "enum";
            let kind = if keyword == "fn" { Kind::Function } else { Kind::Item };
            found.push(Definition { kind, name, line: line_number });
            if (is_enum || keyword == "struct") && code.trim_end().ends_with('{') {
                body = Some((indentation, is_enum));
            } else if keyword == "struct" && code.contains('{') {
                found.extend(inline_fields(code, line_number));
            }
            continue;
        }
        let Some((outer, is_enum)) = body else { continue };
        if indentation <= outer && code.trim_start().starts_with('}') {
            body = None;
        } else if is_enum && indentation == outer + 4 {
            let name = leading_name(code.trim_start());
            found.extend(name.map(|name| Definition { kind: Kind::Variant, name, line: line_number }));
            found.extend(inline_fields(code, line_number));
        } else if indentation >= outer + 4 {
            found.extend(field(code).map(|name| Definition { kind: Kind::Field, name, line: line_number }));
        }
    }
    found
}

/// A line without its comment and without attributes.
fn code_of(line: &str) -> &str {
    let code = line.split_once("//").map_or(line, |(code, _)| code);
    if code.trim_start().starts_with('#') { "" } else { code }
}

/// The keyword and name of an item that begins on this line.
fn item(code: &str) -> Option<(&'static str, &str)> {
    let mut words = code.trim_start().split([' ', '(']).filter(|word| !word.is_empty()).peekable();
    while let Some(word) = words.next() {
        let modifies =
            matches!(word, "pub" | "unsafe" | "async" | "default" | "extern" | "crate)" | "super)" | "self)")
                || word.starts_with('"')
                || (word == "const" && matches!(words.peek(), Some(&("fn" | "unsafe"))))
                || word == "in"
                || (word.ends_with(')') && word.contains("::"));
        if modifies {
            continue;
        }
        let keyword = KEYWORDS.into_iter().find(|keyword| *keyword == word)?;
        return Some((keyword, leading_name(words.next()?)?));
    }
    None
}

/// The field that this line declares.
fn field(code: &str) -> Option<&str> {
    let (before, _) = code.split_once(": ")?;
    let name = before.trim().rsplit(' ').next()?;
    let plain = !before.contains(['(', '<', '"', '=']) || before.trim().starts_with("pub(");
    (plain && leading_name(name) == Some(name)).then_some(name)
}

/// Fields in braces on one line: `Variant { a: f32, b: f32 }`.
fn inline_fields(code: &str, line: usize) -> Vec<Definition<'_>> {
    let Some((_, inside)) = code.split_once('{') else { return Vec::new() };
    let names = inside.split(',').filter_map(field);
    names.map(|name| Definition { kind: Kind::Field, name, line }).collect()
}

/// The identifier that a text begins with.
fn leading_name(text: &str) -> Option<&str> {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    (end > 0 && !text.starts_with(|c: char| c.is_ascii_digit())).then_some(&text[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(kind: Kind, source: &str) -> Vec<&str> {
        definitions(source).into_iter().filter(|found| found.kind == kind).map(|found| found.name).collect()
    }

    #[test]
    fn items_of_every_sort_are_found() {
        let source = "pub(crate) struct A;\npub enum B {\n}\nimpl A {\n    pub const fn c(self) {}\n    \
                      pub(in crate::x) unsafe fn d() {}\n}\nmod e;\ntype F = u8;\nconst G: u8 = 0;\nstatic H: u8 = 0;\n\
                      pub trait I: Sized {}\nextern \"C\" fn j() {}\n";
        assert_eq!(of(Kind::Item, source), ["A", "B", "e", "F", "G", "H", "I"]);
        assert_eq!(of(Kind::Function, source), ["c", "d", "j"]);
    }

    #[test]
    fn fields_and_variants_are_found_and_only_those() {
        let source = "struct A {\n    /// Doc: of it.\n    #[serde(rename: x)]\n    pub one: f32,\n    pub(crate) two: Vec<u8>,\n}\n\
                      enum B {\n    Plain,\n    With { three: f32 },\n    Long {\n        four: f32,\n    },\n    Tuple(u8),\n}\n\
                      fn f(\n    argument: f32,\n) -> A {\n    A { not: 1 }\n}\nstruct C { five: u8 }\n";
        assert_eq!(of(Kind::Field, source), ["one", "two", "three", "four", "five"]);
        assert_eq!(of(Kind::Variant, source), ["Plain", "With", "Long", "Tuple"]);
    }

    #[test]
    fn uses_calls_and_prose_define_nothing() {
        let source = "use a::Course;\n// struct Course\nlet course = Course::new();\nmatch x { Course { a: b } => {} }\n";
        assert_eq!(definitions(source), []);
    }
}
