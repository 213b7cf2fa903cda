//! Reads tags out of XML text, with their lines, by the rules of tinyxml2, which MuJoCo reads it with. Knows
//! no MJCF. Refuses what MJCF has no use for and what the two could read differently: declarations, CDATA,
//! bytes of value 0.

use super::super::model_error::ModelError;

/// A tag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tag<'a> {
    /// `<name ...>` or `<name .../>`.
    Open {
        /// Name of the element.
        name: &'a str,
        /// The text of its attributes, well-formed.
        attributes: Attributes<'a>,
        /// True when it closes itself.
        empty: bool,
    },
    /// `</name>`.
    Close,
}

/// Walks through a text from tag to tag.
pub(super) struct Tags<'a> {
    rest: &'a str,
    line: usize,
}

impl<'a> Tags<'a> {
    pub(super) fn of(text: &'a str) -> Self {
        Self { rest: text, line: 1 }
    }

    /// Line of the tag that was read last, from 1; of its end if it is spread over several.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// The next tag; `None` at the end of the text.
    pub(super) fn next(&mut self) -> Result<Option<Tag<'a>>, ModelError> {
        loop {
            let Some(at) = self.rest.find('<') else {
                self.skip(self.rest.len())?;
                return Ok(None);
            };
            self.skip(at)?;
            if self.rest.starts_with("<!--") {
                self.skip_past(4, "-->", "the end --> of a comment")?;
            } else if self.rest.starts_with("<?") {
                self.skip_past(2, "?>", "the end ?> of an instruction")?;
            } else if self.rest.starts_with("<!") {
                return Err(self.error("elements, attributes and comments only"));
            } else {
                return self.tag().map(Some);
            }
        }
    }

    /// Reads the tag at which the text begins.
    fn tag(&mut self) -> Result<Tag<'a>, ModelError> {
        self.skip(1)?;
        self.skip_space()?;
        let closes = self.rest.starts_with('/');
        self.skip(usize::from(closes))?;
        let name = self.name()?;
        if closes {
            self.skip_space()?;
            self.skip_exactly(">", "the end > of a tag")?;
            return Ok(Tag::Close);
        }
        let start = self.rest;
        loop {
            self.skip_space()?;
            // `rest` is what is left of `start`.
            let attributes = Attributes { rest: &start[..start.len() - self.rest.len()] };
            if self.rest.starts_with("/>") {
                self.skip(2)?;
                return Ok(Tag::Open { name, attributes, empty: true });
            }
            if self.rest.starts_with('>') {
                self.skip(1)?;
                return Ok(Tag::Open { name, attributes, empty: false });
            }
            self.attribute()?;
        }
    }

    fn attribute(&mut self) -> Result<(), ModelError> {
        self.name()?;
        self.skip_space()?;
        self.skip_exactly("=", "= after the name of an attribute")?;
        self.skip_space()?;
        let quote = if self.rest.starts_with('\'') { "'" } else { "\"" };
        self.skip_exactly(quote, "a quoted value of an attribute")?;
        self.skip_past(0, quote, "the closing quote of an attribute")
    }

    fn name(&mut self) -> Result<&'a str, ModelError> {
        let length = self.rest.find(|c| !is_name(c)).unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(length);
        if !name.starts_with(|c| is_name(c) && !matches!(c, '0'..='9' | '.' | '-')) {
            return Err(self.error("a name"));
        }
        self.rest = rest;
        Ok(name)
    }

    fn skip_space(&mut self) -> Result<(), ModelError> {
        self.skip(self.rest.len() - self.rest.trim_start_matches(is_space).len())
    }

    fn skip_exactly(&mut self, text: &str, expected: &'static str) -> Result<(), ModelError> {
        if !self.rest.starts_with(text) {
            return Err(self.error(expected));
        }
        self.skip(text.len())
    }

    /// Skips to behind the next `end` that begins at `from` or later.
    fn skip_past(&mut self, from: usize, end: &str, expected: &'static str) -> Result<(), ModelError> {
        // Callers pass the length of ASCII that `rest` starts with.
        match self.rest[from..].find(end) {
            Some(at) => self.skip(from + at + end.len()),
            None => Err(self.error(expected)),
        }
    }

    /// Skips so many bytes and counts the lines in them.
    fn skip(&mut self, bytes: usize) -> Result<(), ModelError> {
        let (skipped, rest) = self.rest.split_at(bytes);
        for byte in skipped.bytes() {
            match byte {
                b'\n' => self.line += 1,
                0 => return Err(self.error("text without bytes of value 0")),
                _ => {}
            }
        }
        self.rest = rest;
        Ok(())
    }

    fn error(&self, expected: &'static str) -> ModelError {
        ModelError::Xml { line: self.line, expected }
    }
}

/// The attributes of a tag, pairs of name and value as they stand in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Attributes<'a> {
    rest: &'a str,
}

impl<'a> Iterator for Attributes<'a> {
    type Item = (&'a str, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        let text = self.rest.trim_start_matches(is_space);
        let (name, text) = text.split_once('=')?;
        let text = text.trim_start_matches(is_space);
        let quote = text.chars().next()?;
        // `quote` is the first character of `text`.
        let (value, rest) = text[quote.len_utf8()..].split_once(quote)?;
        self.rest = rest;
        Some((name.trim_end_matches(is_space), value))
    }
}

/// The spaces of C's `isspace`.
fn is_space(c: char) -> bool {
    matches!(c, ' ' | '\t' | '\n' | '\r' | '\x0b' | '\x0c')
}

fn is_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || matches!(c, '_' | ':' | '.' | '-') || !c.is_ascii()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tags(text: &str) -> Result<Vec<(usize, String)>, ModelError> {
        let (mut tags, mut found) = (Tags::of(text), Vec::new());
        while let Some(tag) = tags.next()? {
            let words = match tag {
                Tag::Open { name, attributes, empty } => {
                    let attributes: Vec<_> = attributes.map(|(n, v)| format!("{n}={v}")).collect();
                    format!("{name}[{}]{}", attributes.join(","), if empty { "/" } else { "" })
                }
                Tag::Close => "/".into(),
            };
            found.push((tags.line(), words));
        }
        Ok(found)
    }

    #[test]
    fn tags_have_names_attributes_and_lines() {
        let text = "<?xml version='1.0'?>\n<a>\n<!-- <b> \n -->< c x = 'a > \"b' \n y=\"<d>\"/>text</a >";
        let found = tags(text).unwrap();
        let found: Vec<_> = found.iter().map(|(line, words)| (*line, words.as_str())).collect();
        assert_eq!(found, [(2, "a[]"), (5, "c[x=a > \"b,y=<d>]/"), (5, "/")]);
    }

    #[test]
    fn what_is_no_tag_is_refused_with_its_line() {
        for (text, line) in [
            ("<a>\n<", 2),
            ("\n\n<a x>", 3),
            ("<a x=1>", 1),
            ("<a\n x='1>", 2),
            ("<!-- \n", 1),
            ("<?xml", 1),
            ("<!DOCTYPE a [<!ENTITY b 'c'>]>", 1),
            ("<a>\n<![CDATA[ <b> ]]></a>", 2),
            ("<a>\n\0</a>", 2),
            ("<1a>", 1),
            ("<a></a", 1),
        ] {
            let error = tags(text).unwrap_err();
            assert!(
                matches!(error, ModelError::Xml { line: found, .. } if found == line),
                "{text:?}: {error}"
            );
        }
    }
}
