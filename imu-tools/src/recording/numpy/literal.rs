//! The part of Python's literals that NumPy writes into headers.

/// A literal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Literal {
    /// `'text'`
    Text(String),
    /// `17`
    Number(u64),
    /// `True`, `False`
    Bool(bool),
    /// `(1, 2)` or `[1, 2]`
    List(Vec<Literal>),
    /// `{'key': 1}`
    Dict(Vec<(String, Literal)>),
}

/// Deeper nesting is no header.
const DEEPEST: usize = 8;

impl Literal {
    /// The literal that is all of `text`.
    pub fn parse(text: &[u8]) -> Option<Self> {
        let mut parser = Parser { rest: text };
        let literal = parser.literal(DEEPEST)?;
        parser.rest.trim_ascii().is_empty().then_some(literal)
    }

    /// What stands under a key of a dictionary.
    pub fn get(&self, key: &str) -> Option<&Self> {
        let Self::Dict(pairs) = self else { return None };
        pairs.iter().find(|(name, _)| name == key).map(|(_, value)| value)
    }
}

struct Parser<'a> {
    rest: &'a [u8],
}

impl Parser<'_> {
    /// Passes over `byte`, and blanks before it, if it is next.
    fn take(&mut self, byte: u8) -> bool {
        self.rest = self.rest.trim_ascii_start();
        match self.rest.split_first() {
            Some((first, rest)) if *first == byte => {
                self.rest = rest;
                true
            }
            _ => false,
        }
    }

    fn word(&mut self, word: &[u8]) -> Option<()> {
        self.rest = self.rest.strip_prefix(word)?;
        Some(())
    }

    fn literal(&mut self, depth: usize) -> Option<Literal> {
        let depth = depth.checked_sub(1)?;
        self.rest = self.rest.trim_ascii_start();
        match self.rest.first()? {
            b'\'' | b'"' => self.text().map(Literal::Text),
            b'0'..=b'9' => self.number().map(Literal::Number),
            b'T' => self.word(b"True").map(|()| Literal::Bool(true)),
            b'F' => self.word(b"False").map(|()| Literal::Bool(false)),
            b'(' => self.list(b'(', b')', depth),
            b'[' => self.list(b'[', b']', depth),
            b'{' => self.dict(depth),
            _ => None,
        }
    }

    fn text(&mut self) -> Option<String> {
        let (quote, rest) = self.rest.split_first()?;
        let end = memchr::memchr(*quote, rest)?;
        let text = String::from_utf8_lossy(rest.get(..end)?).into_owned();
        self.rest = rest.get(end + 1..)?;
        Some(text)
    }

    fn number(&mut self) -> Option<u64> {
        let digits = self.rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let (digits, rest) = self.rest.split_at_checked(digits)?;
        // Python 2 marks long numbers.
        self.rest = rest.strip_prefix(b"L").unwrap_or(rest);
        std::str::from_utf8(digits).ok()?.parse().ok()
    }

    fn list(&mut self, open: u8, close: u8, depth: usize) -> Option<Literal> {
        let mut items = Vec::new();
        let mut more = self.take(open);
        while !self.take(close) {
            if !more {
                return None;
            }
            items.push(self.literal(depth)?);
            more = self.take(b',');
        }
        Some(Literal::List(items))
    }

    fn dict(&mut self, depth: usize) -> Option<Literal> {
        let mut pairs = Vec::new();
        let mut more = self.take(b'{');
        while !self.take(b'}') {
            if !more {
                return None;
            }
            self.rest = self.rest.trim_ascii_start();
            let key = self.text()?;
            if !self.take(b':') {
                return None;
            }
            pairs.push((key, self.literal(depth)?));
            more = self.take(b',');
        }
        Some(Literal::Dict(pairs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_of_numpy() {
        let text = b"{'descr': [('t', '<i8'), ('gyro', '<f8', (3,))], 'fortran_order': False, \
                     'shape': (10L,), }     \n";
        let header = Literal::parse(text).unwrap();
        assert_eq!(header.get("fortran_order"), Some(&Literal::Bool(false)));
        assert_eq!(header.get("shape"), Some(&Literal::List(vec![Literal::Number(10)])));
        let Some(Literal::List(fields)) = header.get("descr") else { panic!("{header:?}") };
        assert_eq!(fields.len(), 2);
        assert_eq!(header.get("none"), None);
    }

    #[test]
    fn what_is_no_literal_is_refused() {
        for text in ["", "{", "{'a': }", "(1 2)", "[1,,2]", "{1: 2}", "'a", "Tru", "1 2", "(,)"] {
            assert_eq!(Literal::parse(text.as_bytes()), None, "{text}");
        }
        assert_eq!(Literal::parse("(".repeat(100_000).as_bytes()), None);
    }
}
